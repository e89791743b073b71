"""Truth by another way: what the paper prints, and equations blocksim does not use itself."""

import tomllib
from pathlib import Path

import numpy as np

_PRINTED = Path(__file__).with_name("validation") / "cocchetti_rizzi_2024.toml"
PAPER = tomllib.loads(_PRINTED.read_text("utf-8"))
"""Its numbers, each with its figure, table or section."""
Value = float | np.ndarray


def lower_thrust(beta: Value, eta: Value) -> Value:
    """Thrust with hinges at crown extrados and haunch intrados, h_L (1)."""
    numerator = (2 - eta) * beta * np.sin(beta) - 2 * (1 - np.cos(beta))
    return numerator / (2 + eta - (2 - eta) * np.cos(beta))


def upper_thrust(half_angle: Value, beta: Value, eta: Value) -> Value:
    """Thrust with hinges at shoulder extrados and haunch intrados, h_U (2)."""
    numerator = (
        (2 + eta) * half_angle * np.sin(half_angle)
        - (2 - eta) * beta * np.sin(beta)
        - 2 * (np.cos(beta) - np.cos(half_angle))
    )
    return numerator / ((2 - eta) * np.cos(beta) - (2 + eta) * np.cos(half_angle))


def whole_thrust(half_angle: Value, eta: Value) -> Value:
    """Thrust with hinges at crown and shoulder extrados, h_2 (3)."""
    return half_angle / np.tan(half_angle / 2) - 2 / (2 + eta)


def tangency_thrust(beta: Value, eta: Value) -> Value:
    """Thrust whose line is tangent to the intrados at beta, h_e (4)."""
    return beta / np.tan(beta) - eta / (2 - eta)
