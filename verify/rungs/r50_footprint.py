"""Flash, RAM, stack and instructions on Cortex-M equal those in the texts on c_core, and there is no recursion."""

from __future__ import annotations

from dataclasses import replace

from verify import footprint
from verify.context import Context
from verify.rung import Figure, Rung, planted
from verify.targets import TARGETS

RECURSION = "00000000 <gw_a>:\n   0:\tpush\t{r4, lr}\n   2:\tbl\t8 <gw_b>\n\n00000008 <gw_b>:\n   8:\tbl\t0 <gw_a>\n"
POINTER = "00000000 <gw_a>:\n   0:\tblx\tr3\n"


def check(context: Context) -> Figure:
    measured = {target.name: footprint.measure(context, target) for target in footprint.MACHINES}
    parts = footprint.measure_parts(context, TARGETS["cortex-m4f"])
    steps = footprint.measure_steps(context, TARGETS["cortex-m4f"])
    values = footprint.recorded(measured, parts, steps)
    footprint.check(context.root, values)
    with planted("a part that grew", shows="does not show what was measured"):
        footprint.check_parts(context.root, {name: (fast + 4, small) for name, (fast, small) in parts.items()}, steps)
    with planted("a longer step", shows="does not show what was measured"):
        footprint.check_parts(context.root, parts, {name: step + 1 for name, step in steps.items()})
    with planted("recursion", shows="recursion: gw_a -> gw_b -> gw_a"):
        footprint.worst_stack(RECURSION, {}, "gw_a")
    with planted("a call through a pointer", shows="through a pointer"):
        footprint.worst_stack(POINTER, {}, "gw_a")
    m4f = measured["cortex-m4f"]
    with planted("one instruction more", shows=f"measured {m4f.step_recorded + 1:,}"):
        footprint.check_table(context.root, {"cortex-m4f": replace(m4f, step_recorded=m4f.step_recorded + 1)})
    return Figure(
        f"Cortex-M4F: flash {m4f.flash} B, RAM {m4f.controller_ram} B + window, stack {m4f.stack} B, "
        f"step {m4f.step_searched} instructions, servo {m4f.servo_step}",
        values,
    )


RUNG = Rung(
    "flash, RAM, stack and instructions as the texts say",
    tuple(dict.fromkeys([footprint.SIZE, footprint.OBJDUMP, *[t for m in footprint.MACHINES for t in m.tools]])),
    check,
)
