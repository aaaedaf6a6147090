"""Changed copies of whole inputs: bytes, lines, words and numbers, by a trial's random numbers."""

import gzip
import json

# Words that mean something to a format, and numbers that break arithmetic.
WORDS = """nan inf -inf 1e308 -1e308 1e-320 1e400 0 -0 -1 4294967296 9223372036854775808 18446744073709551616 ? . " ' ;
# _ loop_ data_x _atom_site.id ATOM HETATM MODEL ENDMDL END TER solid facet vertex endfacet v f f_1//1_2//2_3//3
f_-1_-2_-3 OFF ply element_vertex_9999999999 property_list_uchar_int end_header null [ { = : , true""".split()
BYTES = [b"\0", b"\r", b"\r\n", b"\t", b"\x1b[2J", b"\xff\xfe", "\ufeff".encode(), "\u00e9".encode(), b"\n\n", b"\x7f"]


def change_bytes(random, data):
    at = random.randrange(len(data) + 1)
    end = min(len(data), at + random.choice([1, 2, 8, 64]))
    kind = random.randrange(5)
    if kind == 0 and data:
        at = min(at, len(data) - 1)
        return data[:at] + bytes([data[at] ^ 1 << random.randrange(8)]) + data[at + 1 :]
    if kind == 1:
        return data[:at] + random.choice(BYTES) + data[at:]
    if kind == 2:
        return data[:at] + data[end:]
    if kind == 3:
        return data[:at] + random.randbytes(end - at) + data[end:]
    return data[:at]


def change_lines(random, data):
    lines = data.splitlines(keepends=True)
    if not lines:
        return data
    one, other = random.randrange(len(lines)), random.randrange(len(lines))
    kind = random.randrange(4)
    if kind == 0:
        lines[one], lines[other] = lines[other], lines[one]
    elif kind == 1:
        lines.insert(other, lines[one])
    elif kind == 2:
        del lines[one]
    else:
        words = lines[one].split(b" ")
        random.shuffle(words)
        lines[one] = b" ".join(words)
    return b"".join(lines)


def change_words(random, data):
    """Replaces a word by another, in the columns where it stood or not."""
    lines = data.split(b"\n")
    place = random.randrange(len(lines))
    line = lines[place]
    separator = next((mark for mark in (b",", b";", b" ") if mark in line), b" ")
    cells = line.split(separator)
    which = random.randrange(len(cells))
    word = random.choice(WORDS).replace("_", " ").encode()
    cells[which] = word.rjust(len(cells[which])) if random.random() < 0.5 else word
    lines[place] = separator.join(cells)
    return b"\n".join(lines)


def mutated(random, seed):
    """A copy of an input with one to six changes; at times nothing, or bytes at random."""
    if random.random() < 0.03:
        return random.choice([b"", b"\n", random.randbytes(300), b"\0" * 300, b"\xef\xbb\xbf" + seed])
    for _ in range(random.randint(1, 6)):
        seed = random.choice([change_bytes, change_lines, change_words, change_words])(random, seed)
    return seed


def mutated_gzip(random, seed):
    """A gzip file that is changed after or before it was packed, cut short, or followed by something."""
    packed = gzip.compress(seed, mtime=0)
    kind = random.randrange(4)
    if kind == 0:
        return packed[: random.randrange(len(packed))]
    if kind == 1:
        return packed + random.choice([b"\0" * 512, b"more", packed, random.randbytes(20)])
    if kind == 2:
        return gzip.compress(mutated(random, seed), mtime=0)
    return change_bytes(random, packed)


HOSTILE = [None, -1, 0, 1e308, 10**15, 2**64, "", "NaN", [], {}, True, "x" * 10000, [1] * 50, "\u001b[2J", -1e-300]


def mutated_json(random, seed):
    """A record with one to three values replaced, or one that is cut or has bytes changed."""
    if random.random() < 0.3:
        at = random.randrange(len(seed))
        return seed[:at] if random.random() < 0.5 else seed[:at] + random.choice(BYTES) + seed[at + 1 :]
    record = json.loads(seed)
    for _ in range(random.randint(1, 3)):
        # An earlier change may have replaced or removed one.
        inner = random.choice([record, record.get("options"), record.get("inputs")])
        while isinstance(inner, (dict, list)) and inner:
            key = random.choice(list(inner) if isinstance(inner, dict) else range(len(inner)))
            if isinstance(inner[key], (dict, list)) and inner[key] and random.random() < 0.9:
                inner = inner[key]
                continue
            if random.random() < 0.2 and isinstance(inner, dict):
                del inner[key]
            else:
                inner[key] = random.choice(HOSTILE)
            break
    return json.dumps(record).encode()
