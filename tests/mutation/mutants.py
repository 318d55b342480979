"""The changes that mutate.py makes of a C file.

relational   one comparison for another        logical    && for ||, and back; ! removed
arithmetic   one operator for another; -x: x   operand    one side of && or || removed
constant     1 more, 1 less; twice, half       statement  removed
negation     of a condition that is neither a comparison nor has a ! before it
"""
import collections
import re

import tree_sitter
import tree_sitter_c

RELATIONAL = {"<": ("<=", ">="), "<=": ("<", ">"), ">": (">=", "<="), ">=": (">", "<"),
              "==": ("!=",), "!=": ("==",)}
ARITHMETIC = {"+": "-", "-": "+", "*": "/", "/": "*", "%": "*", "<<": ">>", ">>": "<<",
              "&": "|", "|": "&", "^": "|", "++": "--", "--": "++", "+=": "-=", "-=": "+=",
              "*=": "/=", "/=": "*=", "|=": "&=", "&=": "|=", "<<=": ">>=", ">>=": "<<="}
LOGICAL = {"&&": "||", "||": "&&"}
CONDITIONED = ("if_statement", "while_statement", "do_statement", "for_statement",
               "conditional_expression")
REMOVED = ("expression_statement", "return_statement", "break_statement", "continue_statement")
# Not code that runs, or without a meaning of its own.
SKIPPED = ("sizeof_expression", "preproc_include", "static_assert_declaration", "comment")

Mutant = collections.namedtuple("Mutant", "kind line function before after text lines")


def parse(text):
    """Syntax tree; macros for attributes, which the grammar does not know, are blanked."""
    plain = re.sub(rb"\bAUVID_[A-Z_]+(?=\s+[a-z]\w*[\s*]+\w)", lambda m: b" " * len(m[0]), text)
    return tree_sitter.Parser(tree_sitter.Language(tree_sitter_c.language())).parse(plain).root_node


def constants(literal):
    """Other values than that of a number as C writes it."""
    whole = re.fullmatch(r"(0[xX][0-9a-fA-F]+|[0-9]+)([uUlL]*)", literal)
    if whole:
        value = int(whole[1], 0 if whole[1][:2] in ("0x", "0X") else 10)
        return [f"{other}{whole[2]}" for other in (value + 1, value - 1) if other >= 0]
    value = float(literal.rstrip("fFlL"))
    suffix = literal[len(literal.rstrip("fFlL")):]
    return [f"{other!r}{suffix}" for other in ((2 * value, value / 2) if value else (1.0, -1.0))]


def changes(node):
    """(kind, node, replacement) for what stands at this node of the tree itself."""
    part = node.child_by_field_name

    def text(field):
        return part(field).text.decode()

    operator = text("operator") if part("operator") else None
    if node.type == "binary_expression":
        left, right = text("left"), text("right")
        for other in RELATIONAL.get(operator, ()):
            yield "relational", part("operator"), other
        if operator in ("&", "|"):
            yield "arithmetic", node, f"({left} {ARITHMETIC[operator]} {right})"
        elif operator in ARITHMETIC:
            yield "arithmetic", part("operator"), ARITHMETIC[operator]
        if operator in LOGICAL:
            yield "logical", node, f"({left} {LOGICAL[operator]} {right})"
            yield "operand", node, left
            yield "operand", node, right
    elif node.type in ("assignment_expression", "update_expression") and operator in ARITHMETIC:
        yield "arithmetic", part("operator"), ARITHMETIC[operator]
    elif node.type == "unary_expression":
        if operator == "!":
            yield "logical", node, text("argument")
        elif operator in "-~" and part("argument").type != "number_literal":
            yield "arithmetic", node, text("argument")
    elif node.type == "number_literal":
        for other in constants(node.text.decode()):
            yield "constant", node, other
    elif node.type in ("true", "false"):
        yield "constant", node, {"true": "false", "false": "true"}[node.type]
    elif node.type in REMOVED and not last_return(node):
        yield "statement", node, ";"
    if node.type in CONDITIONED:
        condition = part("condition")
        while condition is not None and condition.type == "parenthesized_expression":
            condition = condition.named_children[0]
        if condition is not None and not negated_elsewhere(condition):
            yield "negation", condition, f"!({condition.text.decode()})"


def negated_elsewhere(condition):
    """Is the condition's contrary among the relational or logical mutants, or a constant's?"""
    operator = condition.child_by_field_name("operator")
    return operator is not None and (operator.text.decode() in RELATIONAL or operator.text == b"!")


def last_return(node):
    """The return of a value at a function's end: without it nothing is returned."""
    return (node.type == "return_statement" and node.named_child_count > 0 and
            node.parent.parent.type == "function_definition")


def walk(node, function=""):
    """(node, the function's name) for everything that can be changed."""
    if node.type in SKIPPED or node.text.startswith(b"_Static_assert"):
        return
    if node.type == "function_definition":
        name = node.child_by_field_name("declarator")
        while name.type != "identifier":
            name = name.child_by_field_name("declarator")
        function = name.text.decode()
    yield node, function
    for i, child in enumerate(node.children):
        if node.type.startswith("preproc_") and node.field_name_for_child(i) == "condition":
            continue
        if node.type == "array_declarator" and node.field_name_for_child(i) == "size":
            continue
        yield from walk(child, function)


def in_macro(node):
    """Constants in the text of a #define, which the tree holds as one piece."""
    for number in re.finditer(rb"(?<![\w.])(0[xX][0-9a-fA-F]+|[0-9][0-9.]*([eE][-+]?[0-9]+)?)"
                              rb"[uUlLfF]*(?![\w.])", node.text):
        for other in constants(number[0].decode()):
            yield node.start_byte + number.start(), node.start_byte + number.end(), other


def line_sets(node):
    """Lines of the node, of what it stands in, and so on, outwards."""
    while node is not None and node.type != "translation_unit":
        yield range(node.start_point.row + 1, node.end_point.row + 2)
        node = node.parent


def of(text):
    """Every mutant of a C file, in the order of the text."""
    found = []

    def add(kind, function, start, end, other, node):
        first, last = text.rfind(b"\n", 0, start) + 1, text.find(b"\n", end)
        one_line = (b" ".join(part.split()).decode() for part in
                    (text[first:last], text[first:start] + other.encode() + text[end:last]))
        found.append(Mutant(kind, text.count(b"\n", 0, start) + 1, function, *one_line,
                            text[:start] + other.encode() + text[end:], list(line_sets(node))))

    for node, function in walk(parse(text)):
        if node.type == "preproc_arg":
            for start, end, other in in_macro(node):
                add("constant", "", start, end, other, node)
        for kind, place, other in changes(node):
            add(kind, function, place.start_byte, place.end_byte, other, place)
    return found
