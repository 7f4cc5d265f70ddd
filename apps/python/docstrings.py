"""Writes the module's docstrings as a C++ table: the documentation comments of public headers, and docstrings.md.

docstrings.py OUTPUT.cpp ROOT HEADER...

A name is "Class::member" or "function"; what is declared again under the same name has "#2" and so on behind it.
Where Python does not have what a comment names, or has it in another form, CHANGES says it in Python's words. A text of
docstrings.md, which lies beside this file, stands in the place of a comment.
"""

import pathlib
import re
import sys

# What a reader of Python knows under another name.
WORDS = [
    (r"std::invalid_argument", "ValueError"),
    (r"std::runtime_error", "OSError"),
    (r"@throws as ", "Raises as "),
    (r"@throws ", "Raises "),
    (r"@param (\w+)", r"\1:"),
    (r"@returns? ", "Returns "),
    (r"@pre ", "Expects "),
    (r"(std|Eigen|clearway)::", ""),
    (r"(\w)::(\w)", r"\1.\2"),
    (r"\bnull\b", "None"),
    (r"\b(is_proved|policies|duration|max_distance)\(\)", r"\1"),  # properties
]
# By name: a part of a comment, and what stands in its place. A part that a comment does not have (any more) is an error.
CHANGES = {
    "ConfigurationSpace": [(" Copies share what they are made of and cost nothing; moving copies, too.", "")],
    "ConfigurationSpace::clearance": [
        ("\n\nat_most: metres; larger ones are reported as this, and take less time.", "")],
    "ConfigurationSpace::is_edge_free": [("options().edge_resolution", "the space's `edge_resolution`")],
    "ContinuedMap": [
        ("(METHODS.md)", "(mapping/METHODS.md)"),
        ("Written by one thread; read through snapshots.", "Threads that write wait for each other.")],
    "FreeSpaceMap": [("Written by one thread; read through snapshots.", "Threads that write wait for each other.")],
    "FreeSpaceMap::erase": [
        ("inside of `eraser`", "inside of a sphere, the eraser"), ("Raises ValueError as `paint`; the radius", "Raises ValueError as paint(); the radius")],
    "FreeSpaceMap::insert": [
        ("a sensor's pose that is finite and not rigid: scaled or mirrored", "a pose that is no rigid motion")],
    "FreeSpaceMap::paint": [("inside `sphere` and keeps the sphere", "inside a sphere and keeps the sphere")],
    "Gate": [(", and stands at stop_from(...)", ", and stands")],
    "Gate::restart": [("none: anywhere", "None: anywhere")],
    "Motion::at": [(" Expects not empty", "")],
    "MotionVerdict::undecided": [
        ("PathVerdict.undecided", "neither proved free nor shown to collide at the finest step; not valid")],
    "NearestBlocked::found": [("false: nothing", "False: nothing")],
    "PaintedVolume": [(" (`shrunk`)", "")],
    "Pick": [("layer_reach() wider and lower", "wider and lower by the padding and a little more than a voxel")],
    "Plan": [(" (keys fixed by the design page)", "")],
    "Plan::end_violation": [
        ("by_goal_box: legs of a beam search may end in the goal's box (Chong 2008, eq. 11), as far from the goal as they "
         "say; `clearway check` refuses those unless told to accept them",
         "A leg of a beam search that ends in its goal's box (Chong 2008, eq. 11) is one, too: `clearway check` refuses it "
         "unless told to accept it.")],
    "Plan::is_proved": [
        ("it joins what was asked: no end_violation(true).",
         "it joins what was asked; legs of a beam search may end in their goal's box.")],
    "Plan::start": [("of no size when", "empty when")],
    "Plan::validation": [("`valid == false` and empty contact", "`valid` is False and `first_contact` empty")],
    "PlannedMotion::unblended": [("in no file", "empty of one from a file")],
    "Robot": [(" Plain data.", "")],
    "ScanCounts::cleared": [("Scan.clear_to", "`clear_to`")],
    "Snapshot": [("cheap to copy, ", "")],
    "Snapshot::last_seen": [("less than seen()->period()", "less than the period of its stamps, at first 1/64 s")],
    "Snapshot::blocked_space": [
        ("of `requirement` inside", "of a policy inside"),
        ("when `requirement` asks for times that the map does not know, or",
         "when `seen_within` asks for times that the map does not know, or is given")],
    "SpaceOptions::seen_within": [(" (Requirement.seen_within)", "")],
    "check_team": [(" (path_check)", "")],
    "goal_configurations": [
        ("Raises ValueError, as the next does, unless `near` is one finite value for each joint",
         "Raises ValueError unless `near` is one finite value for each joint and the pose a rigid motion.")],
    "map_caveat": [(" (integration_caveat)", ""), (" (hand_edit_caveat)", "")],
    "run_team": [(" `out_of_time` ends the run early (timed_out).", "")],
    "trajectory_formats": [("The explicit table of formats:", "The text of a file for a robot's controller, in one of these formats:")],
}
KEYWORDS = {"const", "noexcept", "override", "default", "delete", "friend", "explicit"}


def plain(lines):
    """The lines of one comment as paragraphs and items of lists, in words of Python."""
    text = re.sub(r"\n(?=\s*@(throws|returns?|pre|param)\b)", "\n\n", "\n".join(lines))
    for pattern, word in WORDS:
        text = re.sub(pattern, word, text)
    parts = []
    for part in re.split(r"\n\s*\n", text):
        is_list = re.search(r"^ - |^   [a-z]+  ", part, re.MULTILINE)  # "- item", or words in a column before what they mean
        items = re.split(r"\n(?= - |   [a-z]+  | [A-Z])", part) if is_list else [part]
        items = [re.sub(r"^   ([a-z]+)  +", r"- \1: ", item) for item in items]
        parts.append("\n".join(" ".join(item.split()) for item in items))
    return "\n\n".join(part for part in parts if part)


def changed(name, text):
    """A comment with what CHANGES says of it."""
    for old, new in CHANGES.get(name, []):
        if old not in text:
            raise SystemExit(f"docstrings.py: CHANGES expects '{old}' in the comment of {name}, which says '{text}'")
        text = text.replace(old, new)
    return text


def names_declared(statement):
    """What a declaration declares: a function's name, or those of its variables."""
    statement = re.sub(r"\[\[[^\]]*\]\]|\btemplate\s*<[^>]*>", " ", statement).strip()
    if not statement or statement.startswith(("using", "friend", "namespace", "return")):
        return []
    before = statement.split("=")[0]
    function = re.search(r"([~\w]+)\s*\(", before)
    if function:
        return [function.group(1)]
    parts = re.sub(r"<[^<>]*(<[^<>]*>)?[^<>]*>", "<>", re.sub(r"=[^,]*|\{[^}]*\}?", "", statement)).split(",")
    found = [re.search(r"(\w+)\s*(\[\w*\])?\s*$", part.strip()) for part in parts]
    return [match.group(1) for match in found if match and match.group(1) not in KEYWORDS]


class Header:
    """Reads one header line by line, and keeps in which classes and braces it is."""

    def __init__(self):
        self.scopes = []  # name of a class; "" for another pair of braces
        self.comment, self.statement, self.last = [], "", []
        self.found = []  # [name, comment lines], in order

    def name(self, member):
        return "::".join([scope for scope in self.scopes if scope] + [member])

    def declare(self, names):
        self.last = []
        for member in names:
            self.found.append([self.name(member), list(self.comment)])
            self.last.append(self.found[-1])
        self.comment, self.statement = [], ""

    def opens(self):
        kind = re.search(r"\b(class|struct|enum class|enum)\s+(\w+)[^;()]*$", self.statement)
        is_namespace = re.search(r"\bnamespace\b", self.statement)
        if kind:
            self.declare([kind.group(2)])
            self.scopes.append(kind.group(2))
        elif is_namespace:
            self.statement, self.comment = "", []
            self.scopes.append("")
        else:
            self.scopes.append("{" if "(" in self.statement.split("=")[0] else "=")

    def closes(self):
        scope = self.scopes.pop()
        if scope == "{":  # the body of a function
            self.declare(names_declared(self.statement))
        elif scope != "=":
            self.statement = ""

    def line(self, text):
        code, mark, comment = text.partition("//")
        if mark and comment.startswith("/") and not comment.startswith("/<") and not code.strip():
            self.comment.append(comment[1:])
            self.last = []
            return
        for character in "" if code.lstrip().startswith("#") else code:
            inside = self.scopes and self.scopes[-1] in ("{", "=")
            if character == "{":
                self.opens()
            elif character == "}":
                self.closes()
            elif inside:
                continue
            elif character == ";":
                self.declare(names_declared(self.statement))
            elif character == "," and self.is_enumeration():
                self.declare(names_declared(self.statement))
            else:
                self.statement += character
        self.statement += " "
        if mark and comment.startswith("/<"):
            for declared in self.last:
                declared[1].append(comment[2:])
        elif code.strip() == "" and not mark and not self.statement.strip():
            self.comment = []  # an empty line: the comment above belongs to nothing

    def is_enumeration(self):
        return bool(self.scopes) and self.scopes[-1] not in ("", "{", "=") and "(" not in self.statement \
            and re.fullmatch(r"\s*\w+(\s*=.*)?", self.statement) is not None


def docstrings(root, headers):
    """Name and text of everything that the headers' comments describe, by name."""
    texts = {}
    for header in headers:
        reader = Header()
        for text in (root / header).read_text(encoding="utf-8").splitlines():
            reader.line(text)
        for name, comment in reader.found:
            text = plain(comment)
            name = re.sub(r"(^|::)[{=]", "", name)
            if not text:
                continue
            key, number = name, 1
            while key in texts and texts[key] != text:
                number += 1
                key = f"{name}#{number}"
            texts[key] = text
    missing = sorted(set(CHANGES) - set(texts))
    if missing:
        raise SystemExit(f"docstrings.py: CHANGES names {', '.join(missing)}, of which no header has a comment")
    return {name: changed(name, text) for name, text in sorted(texts.items())}


def own_docstrings(file):
    """Name and text of each part of docstrings.md."""
    texts = {}
    for part in re.split(r"^## ", file.read_text(encoding="utf-8"), flags=re.MULTILINE)[1:]:
        name, _, body = part.partition("\n")
        texts[name] = plain([" " + line for line in body.splitlines()])
    return texts


def quoted(text):
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    # A compiler need not take more than 65536 characters in one literal, nor does a reader.
    return '"' + escaped + '"'


def main(output, root, *headers):
    texts = docstrings(pathlib.Path(root), headers) | own_docstrings(pathlib.Path(__file__).with_name("docstrings.md"))
    rows = "".join(f"    {{{quoted(name)}, {quoted(text)}}},\n" for name, text in sorted(texts.items()))
    pathlib.Path(output).write_text(
        '// Made by docstrings.py from the public headers and docstrings.md.\n#include "apps/python/docstrings.hpp"\n\n'
        "namespace clearway {\n\nconst std::map<std::string_view, const char*>& header_comments() {\n"
        "  static const std::map<std::string_view, const char*> comments = {\n" + rows +
        "  };\n  return comments;\n}\n\n}  // namespace clearway\n", encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
