"""An arch in metres and kN: does it stand, how safely, and what does it push?

Clear span 8 m, rise 3 m, thickness 0.45 m, 22 kN/m3, one metre deep. Half of its weight comes
down at each support: the unit weight times half the area between the two circles.
"""

from math import radians, tan

from blocksim import CircularArch, check

arch = CircularArch(
    span=8, rise=3, thickness=0.45, voussoirs=31, density=22_000, friction=tan(radians(35))
)
answer = check(arch)
told = answer.to_dict()
print(answer.verdict, "with a geometrical factor of", round(told["geometrical_factor"], 3))
print(f"thrust {told['thrust_min_kN_per_m']:.2f} to {told['thrust_max_kN_per_m']:.2f} kN/m")

# What a notebook shows; `blocksim render` draws the same to scale.
answer.plot().savefig("engineers_arch.png", dpi=70)

headline = told["reactions"][0]["vertical_kN"]
print(f"each support bears {headline:.2f} kN")
