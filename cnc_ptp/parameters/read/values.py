"""One value against its declaration: type, range and choices are checked, constants get one spelling."""

import math
import re
from collections.abc import Iterable, Mapping

from cnc_ptp.parameters import errors
from cnc_ptp.parameters.declare.declarations import Declaration, Limit, Number, ParameterValue
from cnc_ptp.parameters.read.source import Scalar, Value

NEEDED = {
    "int": "an integer",
    "float": "a number",
    "bool": "true or false (1 or 0)",
    "string": "text",
    "strings": "a list of names",
}


class BadValue(ValueError):
    """An invalid value, with error number and text."""

    def __init__(self, error_id: int, text: str) -> None:
        super().__init__(error_id, text)
        self.error_id = error_id
        self.text = text


def checked_value(declaration: Declaration, value: Value, unit: str) -> ParameterValue:
    """The value in the parameter's type; raises BadValue (25007 type, 25008 range). Limits by parameters come later."""
    if declaration.unset is not None and type(value) is type(declaration.unset) and value == declaration.unset:
        return declaration.unset
    result = typed_value(declaration, value)
    if declaration.type in ("int", "float"):
        check_number(declaration, result, unit)  # type: ignore[arg-type]
    elif declaration.type == "string" and not declaration.choices:
        check_text(declaration, str(result))
    return result


def typed_value(declaration: Declaration, value: Value) -> ParameterValue:
    kind = declaration.type
    if kind == "string" and declaration.choices:
        return constants(declaration, value)
    if declaration.names and isinstance(value, str):
        return named_bits(declaration, value)
    if kind == "bool" and type(value) in (bool, int) and value in (0, 1):
        return bool(value)
    if kind == "int" and type(value) is int:
        return value
    if kind == "float" and type(value) in (int, float):
        return as_float(value)  # type: ignore[arg-type]
    if kind == "string" and isinstance(value, str):
        return value
    if kind == "strings" and isinstance(value, tuple):
        return tuple(name_entry(item) for item in value)
    raise BadValue(errors.WRONG_TYPE, f"value {shown(value)} is {described(value)}, {NEEDED[kind]} is needed")


def name_entry(item: Scalar) -> str:
    """An entry of a list of names."""
    if isinstance(item, str):
        return item
    if type(item) is int:
        raise BadValue(errors.WRONG_TYPE, f'entry {shown(item)} is a number, names are text, quote it: "{item}"')
    raise BadValue(errors.WRONG_TYPE, f"entry {shown(item)} is {described(item)}, {NEEDED['strings']} is needed")


def as_float(value: Number) -> float:
    try:
        return float(value)
    except OverflowError:
        return math.inf if value > 0 else -math.inf


def check_number(declaration: Declaration, value: Number, unit: str) -> None:
    if isinstance(value, float) and not math.isfinite(value):
        raise BadValue(errors.OUT_OF_RANGE, f"value {shown(value)} is not a finite number")
    if declaration.choices:
        if value not in declaration.choices:
            choices = ", ".join(f"{number} ({meaning})" for number, meaning in declaration.choices.items())
            raise BadValue(errors.OUT_OF_RANGE, f"value {shown(value)} is none of {choices}")
        return
    for limit in declaration.lower:
        if not isinstance(limit.value, str) and violates_lower(value, limit, limit.value):
            words = "is below the minimum" if limit.inclusive else "is not above"
            raise BadValue(errors.OUT_OF_RANGE, f"value {shown(value)} {words} {with_unit(limit.value, unit)}")
    for limit in declaration.upper:
        if not isinstance(limit.value, str) and violates_upper(value, limit, limit.value):
            words = "is above the maximum" if limit.inclusive else "is not below"
            raise BadValue(errors.OUT_OF_RANGE, f"value {shown(value)} {words} {with_unit(limit.value, unit)}")


def violates_lower(value: Number, limit: Limit, bound: Number) -> bool:
    return value < bound or (value == bound and not limit.inclusive)


def violates_upper(value: Number, limit: Limit, bound: Number) -> bool:
    return value > bound or (value == bound and not limit.inclusive)


def check_text(declaration: Declaration, value: str) -> None:
    if declaration.max_length and len(value) > declaration.max_length:
        raise BadValue(errors.OUT_OF_RANGE, f"value {shown(value)} is longer than {declaration.max_length} characters")
    if declaration.form and not re.fullmatch(declaration.form, value):
        raise BadValue(errors.OUT_OF_RANGE, f"value {shown(value)} must be {declaration.form_text}")


def named_bits(declaration: Declaration, text: str) -> int:
    """The number of constants joined by |, ACHSMODE_MODULO | ACHSMODE_KEINE_AUTO_RPF, or of 0x… as text."""
    number = 0
    for name in (part.strip() for part in text.split("|")):
        if re.fullmatch("0x[0-9a-fA-F]+", name):
            number |= int(name, 16)
        elif name in declaration.names:
            number |= declaration.names[name]
        else:
            raise BadValue(errors.OUT_OF_RANGE, unknown_constant(text, name, declaration.names))
    return number


def unknown_constant(value: str, name: str, known: Iterable[str]) -> str:
    part = f" has {shown(name)}, which" if name != value else ""
    return f"value {shown(value)}{part} is none of {', '.join(known)}"


def constants(declaration: Declaration, value: Value) -> str:
    """A constant or, with flags, several joined by |, or their number: in the spelling of the declaration."""
    if type(value) is int or (isinstance(value, str) and re.fullmatch("0x[0-9a-fA-F]+", value)):
        number = value if isinstance(value, int) else int(str(value), 16)
        return spelling(declaration, number, shown(value))
    if not isinstance(value, str):
        text = f"value {shown(value)} is {described(value)}, a constant or its number is needed"
        raise BadValue(errors.WRONG_TYPE, text)
    names = [name.strip() for name in value.split("|")] if declaration.flags else [value]
    for name in names:
        if name not in declaration.choices:
            raise BadValue(errors.OUT_OF_RANGE, unknown_constant(value, name, declaration.choices))
    if not declaration.flags:
        return value
    number = 0
    for name in names:
        number |= declaration.choices[name]
    return spelling(declaration, number, shown(value))


def spelling(declaration: Declaration, number: int, text: str) -> str:
    """The constants that make up a number, joined by |; raises BadValue if some bit has no constant."""
    choices: Mapping[str, int] = declaration.choices
    for name, constant in choices.items():
        if constant == number:
            return name
    rest, names = number, []
    for name, constant in sorted(choices.items(), key=lambda item: -item[1]):
        if declaration.flags and constant and rest & constant == constant:
            names.append(name)
            rest &= ~constant
    if rest or not names:
        known = ", ".join(f"{name} 0x{constant:x}" for name, constant in choices.items())
        what = "not a combination" if declaration.flags else "none"
        raise BadValue(errors.OUT_OF_RANGE, f"value {text} is {what} of {known}")
    return " | ".join(reversed(names))


def with_unit(value: object, unit: str) -> str:
    """A limit with its unit: '5 (0.01/s)' if the unit itself begins with a number, '5 mm/s²' otherwise."""
    if not unit:
        return f"{value}"
    return f"{value} ({unit})" if unit[0].isdigit() else f"{value} {unit}"


def shown(value: object) -> str:
    """A value as messages show it, shortened if it is long."""
    if value is None or isinstance(value, bool):
        return {None: "null", True: "true", False: "false"}[value]
    text = f"[{', '.join(map(shown, value))}]" if isinstance(value, tuple) else f"{value!r}"
    return text if len(text) <= 60 else text[:57] + "..."


def described(value: Value) -> str:
    kinds: dict[type, str] = {bool: "a boolean", int: "an integer", float: "a number", str: "text", tuple: "a list"}
    return kinds.get(type(value), "nothing")
