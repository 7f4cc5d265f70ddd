"""Writes the documentation comments of public headers as a C++ table: the module's docstrings have this one source.

docstrings.py OUTPUT.cpp ROOT HEADER...

A name is "Class::member" or "function"; what is declared again under the same name has "#2" and so on behind it.
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
KEYWORDS = {"const", "noexcept", "override", "default", "delete", "friend", "explicit"}


def plain(lines):
    """The lines of one comment as paragraphs, in words of Python."""
    text = re.sub(r"\n(?=\s*@(throws|returns?|pre|param)\b)", "\n\n", "\n".join(lines))
    for pattern, word in WORDS:
        text = re.sub(pattern, word, text)
    paragraphs = [" ".join(part.split()) for part in re.split(r"\n\s*\n", text)]
    return "\n\n".join(part for part in paragraphs if part)


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
    return dict(sorted(texts.items()))


def quoted(text):
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    # A compiler need not take more than 65536 characters in one literal, nor does a reader.
    return '"' + escaped + '"'


def main(output, root, *headers):
    texts = docstrings(pathlib.Path(root), headers)
    rows = "".join(f"    {{{quoted(name)}, {quoted(text)}}},\n" for name, text in texts.items())
    pathlib.Path(output).write_text(
        '// Made by docstrings.py from the public headers.\n#include "apps/python/docstrings.hpp"\n\n'
        "namespace clearway {\n\nconst std::map<std::string_view, const char*>& header_comments() {\n"
        "  static const std::map<std::string_view, const char*> comments = {\n" + rows +
        "  };\n  return comments;\n}\n\n}  // namespace clearway\n", encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
