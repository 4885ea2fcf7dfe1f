"""Closed forms that formulas of a config may use."""

from __future__ import annotations

import math

import numpy as np


def rocking_tilt(width: float, height: float, share: float) -> float:
    """rad, at which a block is let go."""
    return share * _block(width, height, 1.0)[0]


def rocking_impact_time(width: float, height: float, share: float, gravity: float = 9.81) -> float:
    """s, until a block that is let go at `share` of its critical tilt a = atan(width / height) stands upright, turning about one corner:
    theta''  = -p^2 sin(a - theta), p^2 = 3 g / (4 R), R half its diagonal   [G. W. Housner, Bull. Seismol. Soc. Am. 53 (1963) 403-417]
    by quadrature of the energy equation, large angles included; s^2 = 1 - theta / theta0 takes the singularity out."""
    critical, p2 = _block(width, height, gravity)
    start = share * critical
    node, weight = np.polynomial.legendre.leggauss(60)
    s = 0.5 * (node + 1.0)
    speed = np.sqrt(2.0 * p2 * (math.cos(critical - start) - np.cos(critical - start * (1.0 - s**2))))
    return float(np.sum(0.5 * weight * 2.0 * start * s / speed))


def rocking_amplitude(width: float, height: float, share: float) -> float:
    """rad, to the other side after the first impact, which leaves 1 - 1.5 sin^2 a of the spin: the angular momentum about the new corner
    stays, and the other corner does not bounce [Housner 1963]."""
    critical, _ = _block(width, height, 1.0)
    kept = 1.0 - 1.5 * math.sin(critical) ** 2
    return critical - math.acos(math.cos(critical) + kept**2 * (math.cos(critical * (1.0 - share)) - math.cos(critical)))


def chain_motion(time: float, stiffness: float, gravity: float, groups: int, slab: float, blocks: int, block: float) -> float:
    """m, how far the top of a column has sunk when gravity (m/s2) came on at once: `groups` times a mass of `slab` below `blocks` masses of
    `block` (kg), on springs of `stiffness` (N/m), as the sum of its modes (f_k/w_k^2)(1 - cos w_k t)."""
    mass = np.array(([slab] + [block] * int(blocks)) * int(groups))
    n = len(mass)
    springs = 2.0 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1)
    springs[-1, -1] = 1.0
    root = 1.0 / np.sqrt(mass)
    squares, modes = np.linalg.eigh(stiffness * springs * np.outer(root, root))
    swing = modes.T @ (gravity * np.sqrt(mass)) * (1.0 - np.cos(np.sqrt(squares) * time)) / squares
    return float(root[-1] * (modes[-1] @ swing))


def _block(width: float, height: float, gravity: float) -> tuple[float, float]:
    """Critical tilt in rad, p^2 in 1/s2."""
    return math.atan2(width, height), 0.75 * gravity / (0.5 * math.hypot(width, height))


THEORY = {"rocking_tilt": rocking_tilt, "rocking_impact_time": rocking_impact_time,
          "rocking_amplitude": rocking_amplitude, "chain_motion": chain_motion}
