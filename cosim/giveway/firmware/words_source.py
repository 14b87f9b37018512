"""controller_words.h and .c: the controller's inputs and outputs as 32-bit words, in the order of the FMU's."""

from __future__ import annotations

from giveway.firmware.c_text import comment, quoted
from giveway.robot.variables import Variable, table

__all__ = ["words_header", "words_source"]

STATUS = "()"  # in the variable table: what the step returns

_HEADER = """\
/* The controller's inputs and outputs as words of 32 bits, for recordings and lines: one per variable of its FMU, in
 * the order of the value references. A real is the bits of its float, a boolean is 0 or 1.
 *
 * Written by `giveway firmware`. */
#ifndef CONTROLLER_WORDS_H
#define CONTROLLER_WORDS_H

#include "giveway/gw_controller.h"

#define CONTROLLER_INPUT_WORDS {inputs}U
#define CONTROLLER_OUTPUT_WORDS {outputs}U

extern const char *const controller_output_names[CONTROLLER_OUTPUT_WORDS];

void controller_input_from_words(const uint32_t *words, gw_controller_input_t *input);
void controller_output_to_words(gw_status_t status, const gw_controller_output_t *output, uint32_t *words);

#endif
"""

_HELPERS = """\
#include "controller_words.h"

#include <string.h>

#if (GW_REAL_DOUBLE == 1)
#error "a word is a float: build without GW_REAL_DOUBLE, as the FMU is"
#endif

static uint32_t bits(gw_real_t value)
{
    uint32_t word;
    (void)memcpy(&word, &value, sizeof word);
    return word;
}

/* member is a gw_real_t, int32_t or uint32_t. */
static void put(void *member, uint32_t word)
{
    (void)memcpy(member, &word, sizeof word);
}
"""


def words_header() -> str:
    """The text of controller_words.h."""
    variables = table("controller")
    return _HEADER.format(inputs=len(variables.select("input")), outputs=len(variables.select("output")))


def words_source() -> str:
    """The text of controller_words.c."""
    variables = table("controller")
    inputs, outputs = variables.select("input"), variables.select("output")
    names = "".join(f"    {quoted(variable.name)},\n" for variable in outputs)
    return (
        f"{_HELPERS}\nconst char *const controller_output_names[CONTROLLER_OUTPUT_WORDS] = {{\n{names}}};\n\n"
        "void controller_input_from_words(const uint32_t *words, gw_controller_input_t *input)\n{\n"
        + "".join(_from_word(variable, number) for number, variable in enumerate(inputs))
        + "}\n\n"
        "void controller_output_to_words(gw_status_t status, const gw_controller_output_t *output, uint32_t *words)\n"
        "{\n" + "".join(_to_word(variable, number) for number, variable in enumerate(outputs)) + "}\n"
    )


def _from_word(variable: Variable, number: int) -> str:
    member = f"input->{variable.c_core}"
    if variable.type == "boolean":
        return f"    {member} = (words[{number}] != 0U);{_unit(variable)}"
    return f"    put(&{member}, words[{number}]);{_unit(variable)}"


def _to_word(variable: Variable, number: int) -> str:
    member = "status" if variable.c_core == STATUS else f"output->{variable.c_core}"
    if variable.type == "real":
        return f"    words[{number}] = bits({member});{_unit(variable)}"
    value = f"{member} ? 1U : 0U" if variable.type == "boolean" else f"(uint32_t){member}"
    return f"    words[{number}] = {value};{_unit(variable)}"


def _unit(variable: Variable) -> str:
    return f" {comment(variable.unit)}" if variable.unit not in ("", "1") else "\n"
