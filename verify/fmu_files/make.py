"""Makes a hostile FMU from a seed: the same bytes on every machine."""

from __future__ import annotations

import io
import random
import re
import stat
import struct
import warnings
import zipfile
from collections.abc import Callable
from dataclasses import dataclass, field

__all__ = ["MAKERS", "Base", "Made", "bases", "hostile"]

EPOCH = (1980, 1, 1, 0, 0, 0)
DESCRIPTION = "modelDescription.xml"
BUILD = "sources/buildDescription.xml"
TERMINALS = "terminalsAndIcons/terminalsAndIcons.xml"
MANIFEST = "extra/org.example/fmi-ls-manifest.xml"
_XML = '<?xml version="1.0" encoding="UTF-8"?>\n'
SIDE = {
    BUILD: _XML + '<fmiBuildDescription fmiVersion="3.0"><BuildConfiguration modelIdentifier="giveway_bumper">'
    '<SourceFileSet><SourceFile name="all.c"/></SourceFileSet></BuildConfiguration></fmiBuildDescription>',
    TERMINALS: _XML + '<fmiTerminalsAndIcons fmiVersion="3.0"><Terminals><Terminal name="a"/></Terminals>'
    "</fmiTerminalsAndIcons>",
    MANIFEST: _XML + '<a xmlns:fmi-ls="http://fmi-standard.org/fmi-ls-manifest" fmi-ls:fmi-ls-name="a"/>',
}
TEXTS = (
    "", "0", "-1", "1e999", "-INF", "NaN", "nan", "0x10", "1_000", "9" * 30, "9" * 5000, "4294967296", "1e-400", "true",
    "\u00fc\u6f22\U0001f600", "&lt;&amp;", "&#10;&#9;", "&#1;", "&x;", "%s%n%s%n", "../../x", "a" * 20000, "1 " * 5000,
    "der(a)", "'", "[1]", "a.b[1,2].c", "\u202e", "2.0", "3.0", "1.0", "structured", "continuous", "independent",
    "calculatedParameter", "UInt64", "CoSimulation", "$\\frac{a}{0}$", "_a",
)  # fmt: skip
NAMES = (
    "../../x", "/{outside}/x", "..", ".", "/", "", "a/../../../x", "a//b", "C:x", "C:\\x", "\\\\host\\x",
    "a\\..\\..\\x", "con", "a" * 300, "a" * 5000, "a/" * 200 + "b", "a/" * 5000 + "b", "\u00fc", "\x1b[2J", "a\nb",
    "a\0b", DESCRIPTION, "ModelDescription.xml", "binaries", "binaries/", "resources", "sources/a.c", BUILD, TERMINALS,
    MANIFEST, "binaries/x86_64-linux/giveway_bumper.so/x",
)  # fmt: skip
MODES = (stat.S_IFLNK, stat.S_IFIFO, stat.S_IFCHR, stat.S_IFBLK, stat.S_IFSOCK, stat.S_IFDIR, stat.S_IFREG)
DOCTYPES = (
    '<!DOCTYPE a [<!ENTITY x SYSTEM "file:///etc/passwd">]>',
    '<!DOCTYPE a SYSTEM "http://127.0.0.1:9/a.dtd">',
    '<!DOCTYPE a [<!ENTITY x "ha"><!ENTITY y "&x;&x;&x;&x;&x;&x;&x;&x;&x;&x;"><!ENTITY z "&y;&y;&y;&y;&y;&y;&y;">]>',
    "<!DOCTYPE a [<!ENTITY % x SYSTEM 'file:///etc/passwd'> %x;]>",
    "<!DOCTYPE a>",
)


@dataclass(frozen=True)
class Base:
    """A healthy FMU as its files."""

    files: dict[str, bytes]


@dataclass
class Made:
    """A file, and whether its library is the healthy one: only then it may be run.

    Attributes:
        kind: which maker made it.
    """

    kind: str
    content: bytes
    may_run: bool = True


@dataclass
class _Draft:
    """An archive under construction."""

    files: dict[str, bytes]
    more: list[tuple[zipfile.ZipInfo, bytes]] = field(default_factory=list)

    def pack(self) -> bytes:
        stream = io.BytesIO()
        with warnings.catch_warnings(), zipfile.ZipFile(stream, "w") as archive:
            warnings.simplefilter("ignore")  # of duplicate names
            for name, content in self.files.items():
                archive.writestr(_info(name, len(content) < 100_000), content)
            for info, content in self.more:
                archive.writestr(info, content)
        return stream.getvalue()


def bases(packed: list[bytes]) -> list[Base]:
    """From healthy FMUs."""
    found = []
    for content in packed:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            found.append(Base({name: archive.read(name) for name in archive.namelist()}))
    return found


def hostile(seed: int, bases: list[Base], outside: str, kind: str = "") -> Made:
    """The FMU for a seed, of the given kind if any. Absolute names in it point to the folder ``outside``."""
    random_ = random.Random(f"fmu file {seed}")
    base = random_.choice(bases)
    kind = kind or random_.choices(list(MAKERS), [weight for _, weight in MAKERS.values()])[0]
    made = MAKERS[kind][0](random_, _Draft(dict(base.files)), outside)
    made.kind = kind
    return made


def _info(name: str, deflated: bool = True) -> zipfile.ZipInfo:
    info = zipfile.ZipInfo("x", EPOCH)
    info.filename = info.orig_filename = name  # set afterwards, since the constructor would truncate and clean it
    info.compress_type = zipfile.ZIP_DEFLATED if deflated else zipfile.ZIP_STORED
    return info


# --- The archive


def _bytes(random_: random.Random, draft: _Draft, _outside: str) -> Made:
    """Bytes changed, removed, repeated, inserted; half of them in the directory at the end."""
    content = bytearray(draft.pack())
    directory = content.rfind(b"PK\x05\x06") - 1200
    for _ in range(random_.choice((1, 1, 2, 5, 30))):
        at = (
            random_.randrange(max(0, directory), len(content))
            if random_.random() < 0.5
            else random_.randrange(len(content))
        )
        what = random_.randrange(6)
        if what < 3:
            content[at] = random_.choice((0, 1, 0x7F, 0x80, 0xFF, random_.randrange(256)))
        elif what == 3:
            content[at : at + random_.choice((1, 4, 40))] = b""
        elif what == 4:
            content[at:at] = random_.randbytes(random_.choice((1, 4, 40)))
        else:
            content[at : at + 4] = struct.pack("<L", random_.choice((0, 1, 0xFFFF, 0x7FFFFFFF, 0xFFFFFFFE, 0xFFFFFFFF)))
        if len(content) < 100:
            break
    if random_.random() < 0.1:
        content = content[: random_.randrange(len(content))]
    return Made("", bytes(content), may_run=False)


def _entries(random_: random.Random, draft: _Draft, outside: str) -> Made:
    """Names, links, devices, and the same entry again."""
    for _ in range(random_.choice((1, 1, 2, 8))):
        name = random_.choice((*NAMES, *draft.files)).replace("{outside}", outside.strip("/"))
        info = _info(name)
        if random_.random() < 0.3:
            info.external_attr = (random_.choice(MODES) | 0o777) << 16
        draft.more.append((info, random_.choice((b"", b"x", outside.encode(), b"<a/>", bytes(50_000)))))
    if random_.random() < 0.2:
        draft.files.pop(random_.choice(list(draft.files)))
    return Made("", draft.pack())


# Offset in a directory record of 46 bytes, and the field at this offset.
_FIELDS = ((8, "<H"), (10, "<H"), (16, "<L"), (20, "<L"), (24, "<L"), (28, "<H"), (30, "<H"), (38, "<L"), (42, "<L"))


def _directory(random_: random.Random, draft: _Draft, _outside: str) -> Made:
    """A directory with wrong entries: flags, method, checksum, sizes, lengths, attributes, offsets."""
    draft.more.append((_info("resources/zeros"), bytes(random_.choice((10, 100_000, 3_000_000)))))
    content = bytearray(draft.pack())
    records = [found.start() for found in re.finditer(b"PK\x01\x02", content)]
    for _ in range(random_.choice((1, 1, 3))):
        offset, form = random_.choice(_FIELDS)
        most = 0xFFFF if form == "<H" else 0xFFFFFFFF
        value = random_.choice((0, 1, 8, 9, 12, 14, 0x800, 100, most >> 1, most - 1, most, random_.randrange(most)))
        struct.pack_into(form, content, random_.choice(records) + offset, min(value, most))
    return Made("", bytes(content), may_run=False)


def _many(random_: random.Random, draft: _Draft, _outside: str) -> Made:
    """Many entries, or one that unpacks to a huge size."""
    if random_.random() < 0.5:
        for number in range(random_.choice((200, 2_000, 12_000))):
            draft.more.append((_info(f"resources/{number}", deflated=False), b""))
    else:
        draft.more.append((_info("resources/zeros"), bytes(random_.choice((1_000_000, 60_000_000)))))
    return Made("", draft.pack())


# --- XML


def _changed_xml(random_: random.Random, text: str) -> bytes:
    for _ in range(random_.choice((1, 1, 2, 5, 20))):
        text = random_.choice(_XML_CHANGES)(random_, text)
        if len(text) > 3_000_000:
            break
    if random_.random() < 0.05:
        encoding = random_.choice(("utf-16", "utf-16-le", "latin-1", "utf-32", "utf-8-sig"))
        return text.encode(encoding, "replace")
    content = text.encode("utf-8", "surrogatepass")
    if random_.random() < 0.1:
        changed = bytearray(content)
        for _ in range(random_.choice((1, 5))):
            changed[random_.randrange(len(changed))] = random_.randrange(256)
        content = bytes(changed)
    return content


def _attribute(random_: random.Random, text: str) -> str:
    """Another value for some attribute: a nasty text, or the value of another attribute."""
    found = list(re.finditer(r'="([^"]*)"', text))
    if not found:
        return text
    at = random_.choice(found)
    value = random_.choice(TEXTS) if random_.random() < 0.7 else random_.choice(found)[1]
    return f'{text[: at.start()]}="{value}"{text[at.end() :]}'


def _name_of(random_: random.Random, text: str) -> str:
    """A tag or an attribute renamed."""
    found = list(re.finditer(r"(?<=[<\s])[A-Za-z]\w*", text))
    if not found:
        return text
    at, other = random_.choice(found), random_.choice(found)[0]
    return (
        text[: at.start()] + random_.choice((other, "x", "UInt9", "UInt999999999", "a:b", "xmlns")) + text[at.end() :]
    )


def _line(random_: random.Random, text: str) -> str:
    """A line left out, repeated or moved."""
    lines = text.splitlines(keepends=True)
    at = random_.randrange(len(lines))
    what = random_.randrange(4)
    if what == 0:
        del lines[at]
    elif what == 1:
        lines[at:at] = [lines[at]] * random_.choice((1, 10, 1000))
    else:
        lines.insert(random_.randrange(len(lines)), lines.pop(at))
    return "".join(lines) or " "


def _put_in(random_: random.Random, text: str) -> str:
    """XML that needs special treatment by a parser, inserted anywhere."""
    what = random_.choice((
        *DOCTYPES, "<![CDATA[x]]>", "<!-- x -->", "<?x y?>", "<a>", "</a>", "<a/>", "<", ">", "&", '"', "\0", "]]>",
        "<a>" * random_.choice((50, 200, 20_000)), "<a/>" * random_.choice((10, 5_000)), "<!--" + "x" * 100_000,
        "x" * 100_000, " ".join(f'a{i}="{i}"' for i in range(random_.choice((10, 3_000)))),
        '<a x="' + "y" * 200_000 + '"/>',
    ))  # fmt: skip
    places = [found.end() for found in re.finditer(r">", text)] or [0]
    at = random_.choice(places) if random_.random() < 0.7 else random_.randrange(len(text))
    return text[:at] + what + text[at:]


def _cut(random_: random.Random, text: str) -> str:
    start = random_.randrange(len(text))
    return text[:start] + text[start + random_.choice((1, 10, 1000)) :] or " "


_XML_CHANGES: tuple[Callable[[random.Random, str], str], ...] = (
    _attribute, _attribute, _attribute, _attribute, _name_of, _name_of, _line, _put_in, _cut,
)  # fmt: skip


def _description(random_: random.Random, draft: _Draft, _outside: str) -> Made:
    draft.files[DESCRIPTION] = _changed_xml(random_, draft.files[DESCRIPTION].decode())
    return Made("", draft.pack())


def _side_documents(random_: random.Random, draft: _Draft, _outside: str) -> Made:
    for name in random_.sample(list(SIDE), random_.choice((1, 3))):
        draft.files[name] = _changed_xml(random_, SIDE[name])
    if random_.random() < 0.5:
        draft.files["sources/all.c"] = random_.choice(
            (b"int x;", b'#include "b.c"\n' * 100, b"\n" * 100_000, b" " * 100_000)
        )
    return Made("", draft.pack())


def _large_description(random_: random.Random, draft: _Draft, _outside: str) -> Made:
    """A small element repeated very often; compressed, the file is small again."""
    text = draft.files[DESCRIPTION].decode()
    count = random_.choice((20_000, 150_000, 400_000))
    what = random_.choice((
        '<Float64 name="v{0}" valueReference="{0}"/>', "<a/>",
        '<Float64 name="v{0}" valueReference="1" causality="output"/>',
        '<ScalarVariable name="v{0}" valueReference="{0}"><Real derivative="{0}"/></ScalarVariable>',
    ))  # fmt: skip
    section = random_.choice(("<ModelVariables>", "<ModelStructure>", "<UnitDefinitions>", "<TypeDefinitions>"))
    if random_.random() < 0.3:
        rows = f'<Float64 name="v" start="{"1.5 " * count}" x="{"y" * count}"/>'
    else:
        rows = "".join(what.format(number) for number in range(count))
    draft.files[DESCRIPTION] = text.replace(section, section + rows, 1).encode()
    return Made("", draft.pack())


# --- Binaries


def _binary(random_: random.Random, draft: _Draft, _outside: str) -> Made:
    """A library truncated, changed, or for another machine: never to be run."""
    name = next(n for n in draft.files if n.startswith("binaries/"))
    content = bytearray(draft.files[name])
    what = random_.randrange(4)
    if what == 0:
        content = content[: random_.randrange(len(content))]
    elif what == 1:
        content = (
            bytearray(random_.choice((b"MZ", b"\x7fELF", b"\xcf\xfa\xed\xfe", b"\xca\xfe\xba\xbe", b""))) + content[8:]
        )
    else:
        for _ in range(random_.choice((1, 10, 1000))):
            at = random_.randrange(random_.choice((64, 1024, len(content))))
            content[at] = random_.randrange(256)
    draft.files[name] = bytes(content)
    if random_.random() < 0.2:
        draft.files["binaries/win64/giveway_bumper.dll"] = draft.files.pop(name)
    return Made("", draft.pack(), may_run=False)


MAKERS: dict[str, tuple[Callable[[random.Random, _Draft, str], Made], float]] = {
    "description": (_description, 0.45),
    "bytes": (_bytes, 0.15),
    "entries": (_entries, 0.15),
    "directory": (_directory, 0.10),
    "side documents": (_side_documents, 0.09),
    "binary": (_binary, 0.04),
    "many": (_many, 0.004),
    "large description": (_large_description, 0.003),
}
"""By kind: its maker, and how often it is chosen."""
