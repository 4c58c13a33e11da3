#!/usr/bin/env python3
"""Checks what clippy does not: no import circle between the files of a crate, no line of Rust, of
a preset's WGSL or of the docs over 100 columns, and plain words: no comment begins with "What",
"Of", "Whether" or "Who", none speaks of nobody, somebody, whoever or anybody, no message says
"is no …" or "nothing is called so". No variable of a test has one of the names that clippy.toml
disallows (clippy leaves tests out). Every public module of the crates for hosts shows an example
that doc tests compile; the page of the crate begins with it.

An import is a path in a `use` or in code that begins with `crate`, `super`, `self` or a child
module. It counts as one of the file of the deepest module that it names; tests are left out.
`mod x;` alone is none.

    scripts/house.py            exit 0 fine, 1 not
    scripts/house.py --edges    also prints every import
"""

import re
import sys
from pathlib import Path

WIDTH = 100
FOR_HOSTS = ("graph", "gpu", "passes", "compare", "host")
WRITTEN_BY_TESTS = {"diagnostics.md", "reference.md"}
ROOT = Path(__file__).resolve().parent.parent
TOKENS = re.compile(
    r"""//[^\n]*|/\*.*?\*/|b?r(?P<h>\#*)".*?"(?P=h)|b?"(?:\\.|[^"\\])*"|'(?:\\.[^']*|[^'\\\n])'""",
    re.DOTALL | re.VERBOSE,
)


COMMENT = re.compile(r"^\s*(//[/!]?)\s?(.*)$")
RIDDLE = re.compile(r"(?:What|Of|Whether|Whoever|Who)\b(?!')")
PERSON = re.compile(r"\b(?:nobody|somebody|whoever|anybody)\b", re.IGNORECASE)
MESSAGE = re.compile(r'"[^"\n]*(?:(?<!here )\bis no (?!longer|more)|nothing is called so)[^"\n]*"')


def words(text):
    """The lines of Rust or WGSL whose comments or messages are not plain, with the reason."""
    before, previous = None, ""
    for number, line in enumerate(code_without_tests(text), 1):
        comment = COMMENT.match(line)
        kind, said = comment.groups() if comment else (None, "")
        if kind and (before != kind or not previous.strip()) and RIDDLE.match(said):
            yield number, f"a comment begins with `{said.split()[0]}`"
        if kind and PERSON.search(said):
            yield number, "a comment speaks of a person"
        if not kind and MESSAGE.search(line):
            yield number, "a message says `is no`"
        before, previous = kind, said


VAGUE = re.compile(r"(?<![.\w:])(?:of|known|found|said|told|came|all|others|here)\b(?!\s*[:(.!{<\[?])")
BINDING = re.compile(
    r"\blet\s+([^=;{]*?)\s*[=;]|\bfor\s+([^{;]*?)\s+in\b|(?:\(|[=,]|\bmove)\s*\|([^|\n]*)\|"
    r"|^\s*(?:\w+::)*\w+\(([\w\s,&()]*)\)\s*(?:=>|if\b)",
    re.MULTILINE,
)


def vague_names(text):
    """The lines that bind a variable whose name does not say what it holds."""
    text = TOKENS.sub(lambda match: "\n" * match.group().count("\n"), text)
    for match in BINDING.finditer(text):
        for name in VAGUE.finditer(match.group()):
            line = text.count("\n", 0, match.start() + name.start()) + 1
            yield line, f"a variable is called `{name.group()}`"


def code_without_tests(text):
    """The lines of a file without its test module, which names what is tested."""
    lines = text.splitlines()
    for at, line in enumerate(lines):
        if line.startswith("#[cfg(test)]"):
            return lines[:at]
    return lines


def code(text):
    """The text without comments, strings and test modules."""
    text = TOKENS.sub(" ", text)
    out, at = [], 0
    for match in re.finditer(r"#\[cfg\(test\)\]", text):
        if match.start() < at:
            continue
        out.append(text[at : match.start()])
        depth, at = 0, match.end()
        while at < len(text):
            if text[at] in "{(":
                depth += 1
            elif text[at] in "})":
                depth -= 1
            at += 1
            if depth == 0 and text[at - 1] in ";}":
                break
    out.append(text[at:])
    return "".join(out)


def modules(folder):
    """The file of each module of a crate, by the module's path."""
    found = {}
    for file in sorted(folder.rglob("*.rs")):
        parts = list(file.relative_to(folder).with_suffix("").parts)
        if parts[-1] in ("mod", "lib", "main"):
            parts.pop()
        found[tuple(parts)] = file
    return found


def expand(tree):
    """The paths of a `use`: `a::{b, c::{d}}` is `a::b` and `a::c::d`."""
    tree = tree.strip()
    if "{" not in tree:
        return [re.split(r"\s+as\s+", tree)[0].strip()]
    head, rest = tree.split("{", 1)
    rest = rest[: rest.rfind("}")]
    parts, depth, last = [], 0, 0
    for at, sign in enumerate(rest + ","):
        depth += (sign == "{") - (sign == "}")
        if sign == "," and depth == 0:
            parts.append(rest[last:at])
            last = at + 1
    return [head.strip() + path for part in parts if part.strip() for path in expand(part)]


def paths(text):
    uses = re.compile(r"\buse\s+([^;]+);")
    for match in uses.finditer(text):
        yield from expand(match.group(1))
    for match in re.finditer(r"\b[a-z_]\w*(?:::\w+)+", uses.sub(" ", text)):
        yield match.group(0)


def imports(folder):
    known = modules(folder)
    edges = {}
    for module, file in known.items():
        text = code(file.read_text())
        for path in paths(text):
            parts = [part.strip() for part in path.split("::")]
            if parts[0] == "crate":
                at, parts = (), parts[1:]
            elif parts[0] in ("super", "self"):
                at = module
                while parts and parts[0] in ("super", "self"):
                    at = at[:-1] if parts[0] == "super" else at
                    parts = parts[1:]
            elif module + (parts[0],) in known:
                at = module
            else:
                continue
            while parts and at + (parts[0],) in known:
                at, parts = at + (parts[0],), parts[1:]
            target = known.get(at)
            if target and target != file:
                edges.setdefault(file, set()).add(target)
    return edges


def circles(edges):
    """Strongly connected components of more than one file (Tarjan 1972)."""
    number, low, stack, found = {}, {}, [], []

    def visit(node):
        number[node] = low[node] = len(number)
        stack.append(node)
        for other in sorted(edges.get(node, ())):
            if other not in number:
                visit(other)
                low[node] = min(low[node], low[other])
            elif other in stack:
                low[node] = min(low[node], number[other])
        if low[node] == number[node]:
            at = stack.index(node)
            if len(stack) - at > 1:
                found.append(sorted(stack[at:]))
            del stack[at:]

    for node in sorted(edges):
        if node not in number:
            visit(node)
    return found


def without_example(folder):
    """The files of a crate's public modules that show no example of Rust, with the reason."""
    known, left = modules(folder), [()]
    for module in left:
        lines = known[module].read_text().splitlines()
        if lines[0] == '#![doc = include_str!("../README.md")]':
            page = (folder.parent / "README.md").read_text().splitlines()
            lines = [f"//! {line}" for line in page] + lines
        fences = [at for at, line in enumerate(lines) if line.startswith("//! ```")]
        words = {at: set(re.split(r"[`,]+", lines[at][4:])) for at in fences[::2]}
        shown = [at for at in words if words[at] <= {"", "rust", "no_run", "should_panic"}]
        if not shown:
            yield known[module], "the module shows no example that is compiled"
        elif not module and shown[0] > 7:
            yield known[module], "the crate's page does not begin with an example"
        text = code("\n".join(lines))
        uses = [use for tree in re.findall(r"^pub use ([^;]+);", text, re.M) for use in expand(tree)]
        names = uses + re.findall(r"^pub mod (\w+);", text, re.M)
        inner = (module + tuple(name.split("::")) for name in names)
        left += [path for path in inner if path in known and path not in left]


def main():
    sys.setrecursionlimit(10_000)
    failed = 0
    for folder in sorted(ROOT.glob("crates/*/src")):
        edges = imports(folder)
        if "--edges" in sys.argv:
            for file, targets in sorted(edges.items()):
                for target in sorted(targets):
                    print(f"{file.relative_to(ROOT)} -> {target.relative_to(folder)}")
        for circle in circles(edges):
            failed += 1
            print(f"import circle in {folder.relative_to(ROOT)}:")
            for file in circle:
                inside = sorted(str(t.relative_to(folder)) for t in edges[file] if t in circle)
                print(f"    {file.relative_to(folder)} imports {', '.join(inside)}")
    files = list((ROOT / "shaders").rglob("*.wgsl"))
    for folder in ("crates", "tests", "benches", "fuzz", "integrations"):
        files += (ROOT / folder).rglob("*.rs")
    for file in sorted(files):
        if "target" in file.relative_to(ROOT).parts:
            continue
        for number, line in enumerate(file.read_text().splitlines(), 1):
            if len(line) > WIDTH:
                failed += 1
                print(f"{file.relative_to(ROOT)}:{number}: {len(line)} columns")
        is_test = "tests" in file.relative_to(ROOT).parts
        faults = list(words(file.read_text()))
        if file.suffix == ".rs":
            faults += vague_names(file.read_text())
        for number, why in faults:
            # A test says of its own values what they are.
            if is_test and why.startswith("a message"):
                continue
            failed += 1
            print(f"{file.relative_to(ROOT)}:{number}: {why}")
    pages = ("*.md", "docs/*.md", "docs/lab/*.md", "integrations/*/*.md")
    for file in sorted(file for page in pages for file in ROOT.glob(page)):
        if file.name in WRITTEN_BY_TESTS:
            continue
        is_quoted = False
        for number, line in enumerate(file.read_text().splitlines(), 1):
            is_quoted ^= line.startswith("```")
            if PERSON.search(line) and not is_quoted:
                failed += 1
                print(f"{file.relative_to(ROOT)}:{number}: speaks of a person")
            # Tables, programs' words and pictures are as wide as they are.
            if len(line) > WIDTH and not is_quoted and not line.startswith(("|", "    ", "![")):
                failed += 1
                print(f"{file.relative_to(ROOT)}:{number}: {len(line)} columns")
    for crate in FOR_HOSTS:
        for file, why in without_example(ROOT / "crates" / crate / "src"):
            failed += 1
            print(f"{file.relative_to(ROOT)}: {why}")
    fine = "house: no import circle, no long line, plain words, an example in every public module"
    print(f"house: {failed} faults" if failed else fine)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
