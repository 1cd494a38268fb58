#!/usr/bin/env python3
"""Two robots in one world, in virtual time: the second catches up until its bumper touches."""

from cargobay import Robot, Sim, SimTime

with Sim(time=SimTime.VIRTUAL) as ahead, Sim(beside=ahead) as behind:  # its world, its clock
    behind.inject("place -800 0 0")
    with Robot(sim=ahead) as first, Robot(sim=behind) as second:
        first.start()
        second.start()
        for state in second.states():
            first.drive(80.0, 0.0)
            second.drive(200.0, 0.0)
            if state.bumps:
                break
        print(f"caught up after {state.x_mm:.0f} mm")
