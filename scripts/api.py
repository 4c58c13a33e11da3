#!/usr/bin/env python3
"""Lists the public items of the crates for hosts, and compares the list with `scripts/api.txt`: a
change of the public API is seen in a change of that file. It reads the text of the sources, as
rustdoc's list needs a nightly compiler: what `lib.rs` and public modules declare or re-export, with
the fields, variants and methods that are public, in the order of their names.

    scripts/api.py            exit 0 if the list is as it was, 1 with the difference
    scripts/api.py --write    writes the list
"""

import difflib
import re
import sys

from house import ROOT

CRATES = ("graph", "gpu", "passes", "scene", "host")
LIST = ROOT / "scripts" / "api.txt"
BAR = "\N{BROKEN BAR}"
ITEM = re.compile(
    r"^pub (?:const |unsafe |async )*(struct|enum|trait|fn|const|static|type|mod|union)\s+(\w+)", re.MULTILINE
)
USE = re.compile(r"^pub use ([^;]+);", re.MULTILINE)
IMPL = re.compile(r"^impl(?:<[^{]*?>)?\s+(?:(?P<of>[\w:]+)(?:<[^{]*?>)?\s+for\s+)?(?P<name>\w+)[^{]*\{", re.MULTILINE)


def plain(path):
    """The text of a file without comments, its test module, and strings that hold braces."""
    text = path.read_text()
    text = text.split("\n#[cfg(test)]\nmod ")[0]
    text = re.sub(r'"(?:\\.|[^"\\])*"', '""', text, flags=re.DOTALL)
    text = re.sub(r"//[^\n]*|^#!\[[^\]\n]*\]", "", text, flags=re.MULTILINE)
    # A semicolon ends an item, so that of an array's type is another sign for a while.
    return re.sub(r";( \w+\])", BAR + r"\1", text)


def block(text, start):
    """The text between the brace at `start` and the one that closes it."""
    depth = 0
    for at in range(start, len(text)):
        depth += (text[at] == "{") - (text[at] == "}")
        if depth == 0:
            return text[start + 1 : at]
    return text[start + 1 :]


def top(text):
    """The text with the content of inner braces left out."""
    kept, depth = "", 0
    for sign in text:
        depth -= sign == "}"
        kept += sign if depth == 0 else ""
        depth += sign == "{"
    return kept


def one_line(text):
    text = re.sub(r"\s+", " ", text).strip().replace(BAR, ";")
    return re.sub(r",? ?\)", ")", re.sub(r"\( ", "(", text))


def names_of(tree):
    """The names, and what they are called inside, that a `use` tree brings: `a::{b, c as d}`."""
    tree = re.sub(r"\s+", " ", tree).strip()
    if "{" not in tree:
        path, _, renamed = tree.partition(" as ")
        last = path.split("::")[-1].strip()
        return [(renamed.strip() or last, last)]
    inner, found, part, depth = tree[tree.index("{") + 1 : tree.rindex("}")], [], "", 0
    for sign in inner + ",":
        depth += (sign == "{") - (sign == "}")
        if sign == "," and depth == 0:
            found += names_of(part) if part.strip() else []
            part = ""
        else:
            part += sign
    return found


def attributes(text, start):
    """What is derived for the item, and whether it is non-exhaustive."""
    before, found = text[:start].rstrip(), []
    while before.endswith("]"):
        at = before.rindex("#[")
        attribute = one_line(before[at + 2 : -1])
        if attribute.startswith(("derive", "non_exhaustive")):
            found.insert(0, f"#[{attribute}] ")
        before = before[:at].rstrip()
    return "".join(found)


def declared(text, start, kind):
    """The lines of an item: its head, then its public fields, variants or methods."""
    end = re.compile(r"[{;]|=").search(text, start)
    if kind in ("const", "static", "type"):
        return [one_line(text[start : text.index(";", start)].split(" = ")[0])]
    if kind == "struct" and text[end.start()] == ";":
        head = one_line(text[start : end.start()])
        return [attributes(text, start) + re.sub(r"\((?!pub )[^\n]*", "(..)", head)]
    head = [attributes(text, start) + one_line(text[start : end.start()])]
    if kind == "fn":
        return head
    body = top(block(text, end.start()))
    body = re.sub(r"#\[[^\]]*\]", "", body)
    if kind == "struct":
        fields = re.findall(r"\bpub (\w+\s*:[^{}]*?)(?=,\s*(?:pub\b|\w+\s*:|$)|\s*$)", body)
        return head + [f"  {one_line(field)}" for field in fields]
    if kind == "enum":
        return head + [f"  {name}" for name in re.findall(r"(?:^|,|\})\s*([A-Z]\w*)", body)]
    return head + [f"  {one_line(m)}" for m in re.findall(r"\bfn [^{;]*", body)]


def items(crate):
    """The public items of a crate, by name."""
    source = ROOT / "crates" / crate / "src"
    texts = {path: plain(path) for path in sorted(source.rglob("*.rs"))}
    root = texts[source / "lib.rs"]
    shown = {inner: name for use in USE.findall(root) for name, inner in names_of(use)}
    public = {name for kind, name in ITEM.findall(root) if kind == "mod"}
    found = {}
    for path, text in texts.items():
        here = path.relative_to(source).with_suffix("").parts
        module = next((part for part in here if part in public), None)
        for item in ITEM.finditer(text):
            kind, name = item.groups()
            inner = module is not None and path.stem != "lib"
            if name in shown or inner or path.stem == "lib":
                place = f"{module}::{name}" if inner and name not in shown else shown.get(name, name)
                found.setdefault(place, []).extend(declared(text, item.start(), kind))
    for text in texts.values():
        for impl in IMPL.finditer(text):
            name = impl["name"]
            place = shown.get(name, name)
            places = [known for known in found if known == place or known.endswith(f"::{name}")]
            if not places:
                continue
            if impl["of"]:
                found[places[0]].append(f"  impl {one_line(impl.group(0)[4:-1])}")
                continue
            body = top(block(text, impl.end() - 1))
            methods = re.findall(r"\bpub (?:const |unsafe )*(fn [^{;]*)", body)
            found[places[0]] += [f"  {one_line(method)}" for method in methods]
    for name, lines in re.findall(r"^pub use (\w+)(?: as (\w+))?;", root, re.MULTILINE):
        found.setdefault(lines or name, [f"use {name}" + (f" as {lines}" if lines else "")])
    return found


def listed():
    lines = []
    for crate in CRATES:
        if not (ROOT / "crates" / crate / "src" / "lib.rs").exists():
            continue
        lines.append(f"# skiagraph-{crate}")
        for name, of in sorted(items(crate).items()):
            head, rest = of[:1], of[1:]
            lines += [f"{name}: {head[0]}"] + sorted(dict.fromkeys(rest))
        lines.append("")
    return lines


def main():
    now = listed()
    if "--write" in sys.argv:
        LIST.write_text("\n".join(now))
        return
    was = LIST.read_text().split("\n") if LIST.exists() else []
    changes = list(difflib.unified_diff(was, now, "scripts/api.txt", "the sources", lineterm="", n=0))
    if changes:
        print("\n".join(changes))
        print("api: the public API changed; `python3 scripts/api.py --write`, and look at the difference")
        sys.exit(1)
    print(f"api: {len(now)} lines as they were")


if __name__ == "__main__":
    main()
