#!/usr/bin/env python3
"""Check that no two folders of a crate import each other, directly or through others.

usage: import_circles.py [--graph]      from anywhere in the repository

A folder is one at the top of a crate; a file there is one by itself. An import leads to the file that defines the name:
a module's `pub use` is followed, and is no import of its own. Test modules are left out. --graph prints the imports
between folders.
"""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
CRATES = {
    "knotdock": "src",
    "knotdock_cli": "cli/src",
    "knotdock_structures": "structures/src",
    "knotdock_scoring": "scoring/src",
}
USE = re.compile(r"^[ \t]*(pub(?:\([\w: ]+\))? )?use ([^;]+);", re.M)


def without_tests(text):
    """Text less its comments and everything from `#[cfg(test)] mod` to the brace that closes it."""
    text = re.sub(r"//[^\n]*|\bpub\(in [\w:]+\)", "", text)
    while match := re.search(
        r"#\[cfg\(test\)\]\s*(?:pub(?:\([^)]*\))? )?(?:mod \w+|use|fn \w+|impl)[^{;]*([{;])", text
    ):
        end = match.end()
        if match[1] == "{":
            depth = 1
            while depth and end < len(text):
                depth += {"{": 1, "}": -1}.get(text[end], 0)
                end += 1
        text = text[: match.start()] + text[end:]
    return text


def leaves(tree, prefix=()):
    """Paths of a `use` tree, each as a tuple of names."""
    tree = tree.strip()
    if "{" not in tree:
        yield prefix + tuple(name.split(" as ")[0].strip() for name in tree.split("::"))
        return
    head, body = tree[: tree.index("{")], tree[tree.index("{") + 1 : tree.rindex("}")]
    prefix += tuple(name for name in head.split("::") if name.strip())
    depth, start = 0, 0
    for place, letter in enumerate(body + ","):
        depth += {"{": 1, "}": -1}.get(letter, 0)
        if letter == "," and depth == 0:
            if body[start:place].strip():
                yield from leaves(body[start:place], prefix)
            start = place + 1


class Crate:
    """Modules of a crate, and the imports of each from the others."""

    def __init__(self, name, folder):
        self.name, self.files, self.reexports, self.texts = name, {}, {}, {}
        for path in sorted((ROOT / folder).rglob("*.rs")):
            parts = path.relative_to(ROOT / folder).with_suffix("").parts
            if parts[-1] in ("mod", "lib"):
                parts = parts[:-1]
            if parts == ("main",):
                continue
            self.files[parts] = path
            self.texts[parts] = without_tests(path.read_text())
        for module, text in self.texts.items():
            for visible, tree in USE.findall(text):
                if visible:
                    for leaf in leaves(tree):
                        target = self.absolute(module, leaf)
                        if target:
                            self.reexports[module + (target[-1],)] = target

    def absolute(self, module, leaf):
        """A path from the crate's root, or nothing for another crate's."""
        if leaf[0] in ("crate", self.name):
            return leaf[1:]
        if leaf[0] == "self":
            return module + leaf[1:]
        if leaf[0] == "super":
            while leaf and leaf[0] == "super":
                module, leaf = module[:-1], leaf[1:]
            return module + leaf
        if module + leaf[:1] in self.files:
            return module + leaf
        return None

    def defining(self, path):
        """The module that defines the item of a path."""
        for _ in range(10):
            for length in range(len(path), 0, -1):
                target = self.reexports.get(path[:length])
                if target and target != path[:length] and path[:length] not in self.files:
                    path = target + path[length:]
                    break
            else:
                break
        for length in range(len(path), -1, -1):
            if path[:length] in self.files:
                return path[:length]
        return ()

    def roots(self, module):
        """First names of paths that lead to modules of the crate: keywords, and the module's own submodules."""
        children = [path[-1] for path in self.files if len(path) == len(module) + 1 and path[:-1] == module]
        return ["crate", "super", "self", *children]

    def imports(self):
        """Modules by the module that imports them."""
        graph = {}
        for module, text in self.texts.items():
            paths = [leaf for visible, tree in USE.findall(text) if not visible for leaf in leaves(tree)]
            inline = re.findall(rf"(?<![\w:])((?:{'|'.join(self.roots(module))})(?:::\w+)+)", USE.sub("", text))
            paths += [tuple(path.split("::")) for path in inline]
            targets = (self.absolute(module, path) for path in paths)
            found = {self.defining(target) for target in targets if target}
            graph[module] = found - {module}
        return graph


def circles(graph):
    """Strongly connected components of more than one module (Tarjan)."""
    index, low, stack, found = {}, {}, [], []

    def visit(node):
        index[node] = low[node] = len(index)
        stack.append(node)
        for target in graph.get(node, ()):
            if target not in index:
                visit(target)
                low[node] = min(low[node], low[target])
            elif target in stack:
                low[node] = min(low[node], index[target])
        if low[node] == index[node]:
            part = []
            while not part or part[-1] != node:
                part.append(stack.pop())
            if len(part) > 1:
                found.append(sorted(part))

    sys.setrecursionlimit(10_000)
    for node in graph:
        if node not in index:
            visit(node)
    return found


def main():
    failed = False
    for name, folder in CRATES.items():
        crate = Crate(name, folder)
        graph = crate.imports()
        folders = {}
        for module, targets in graph.items():
            for target in targets:
                of_tests = any(part.startswith("test") for part in module + target)
                if module[:1] != target[:1] and module and target and not of_tests:
                    folders.setdefault(module[0], {}).setdefault(target[0], []).append("::".join(module))
        for source, targets in sorted(folders.items() if "--graph" in sys.argv else ()):
            for target, modules in sorted(targets.items()):
                print(f"{name}: {source} -> {target} ({len(modules)}: {', '.join(sorted(modules)[:4])})")
        for part in circles({source: set(targets) for source, targets in folders.items()}):
            failed = True
            print(f"{name}: these folders import each other in a circle: {', '.join(part)}")
            for source in part:
                for target in set(folders.get(source, ())) & set(part):
                    print(f"    {source} imports {target} in {', '.join(sorted(folders[source][target]))}")
    sys.exit(failed)


if __name__ == "__main__":
    main()
