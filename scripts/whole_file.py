"""Writing a file so that an interrupted script leaves the older one, or none, but no part of one."""


def write(path, text):
    partial = path.with_name(path.name + ".partial")
    partial.write_text(text)
    partial.replace(path)
