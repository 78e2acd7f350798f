#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes calls.inc: every public function of the headers called with wrong arguments.

A row is {name, returns a status, has outputs, function}; the function of a row makes the call of variant v:
inputs and outputs are each absent (NULL) or there, texts empty, structures zeroed; numbers are zero
and NaN, or out of range: -1 and infinity. Lengths of memory (size_t) are zero.

usage: make_calls.py OUTPUT HEADER...
"""
import re
import sys

DECLARATION = re.compile(r"PH_API\s+(?!extern)([^;{]*?)\b(ph_\w+)\s*\(([^;]*?)\)\s*(?:PH_PRINTF\([^)]*\))?;", re.S)


structures = set()  # passed by value


def split(text):
    """Arguments at the commas outside parentheses."""
    parts, depth = [""], 0
    for c in text:
        depth += (c == "(") - (c == ")")
        if c == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += c
    return [" ".join(p.split()) for p in parts if p.strip() not in ("", "void")]


def value(argument):
    """The C expression of an argument."""
    if argument == "...":
        return None
    if argument == "ph_error *err":
        return "&err"
    if "(*" in argument and "double (*g)" in argument:
        return "NULL"
    if "*" in argument or "[" in argument:
        if argument.startswith("const char *") and "[" not in argument and argument.count("*") == 1:
            return "text(v)"
        incoming = argument.startswith("const ") and argument.count("*") < 2
        return "%s(v)" % ("in" if incoming else "out")
    if re.match(r"(double|float)\b", argument):
        return "number(v)"
    if re.match(r"(int|long|ptrdiff_t|int32_t)\b", argument):
        return "integer(v)"
    enum = re.match(r"(ph_\w+) \w+$", argument)
    if enum and enum[1] not in structures:
        return "(%s)integer(v)" % enum[1]
    return "0"


def main(output, headers):
    bodies, rows = [], []
    for header in headers:
        with open(header) as f:
            structures.update(re.findall(r"^} (ph_\w+);", re.sub(r"typedef enum.*?;", "", f.read(), flags=re.S), re.M))
    for header in headers:
        with open(header) as f:
            text = re.sub(r"/\*.*?\*/", "", f.read(), flags=re.S)
        for result, name, arguments in DECLARATION.findall(text):
            values = [v for v in map(value, split(arguments)) if v is not None]
            call = "%s(%s)" % (name, ", ".join(values))
            status = result.strip() == "ph_status"
            bodies.append("static ph_status call_%s(int v)\n{\n    ph_error err = PH_ERROR_INIT;\n    (void)v;\n    (void)err;\n"
                          "    %s;\n    return %s;\n}\n" % (name, ("ph_status st = " if status else "(void)") + call,
                                                           "st" if status else "PH_OK"))
            pointers = any(v in ("in(v)", "out(v)", "text(v)") for v in values)
            rows.append('    {"%s", %s, %s, call_%s},\n' % (name, "true" if status and pointers else "false",
                                                          "true" if "out(v)" in values else "false", name))
    with open(output, "w") as f:
        f.write("".join(bodies) + "static const struct call calls[] = {\n" + "".join(rows) + "};\n")


main(sys.argv[1], sys.argv[2:])
