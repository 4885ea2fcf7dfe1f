"""Mean stress of each block from the forces of its contacts."""

from __future__ import annotations

import numpy as np

from talus_lab.run import Run


def block_stress(run: Run, frame: int = -1) -> np.ndarray:
    """[blocks, 2, 2] Pa, compression positive: the mean over each block,
        sigma = -1 / A  sum of f (x) r,
    f the force of a contact on the block, r from its centroid to where it acts   [J. Christoffersen, M.M. Mehrabadi, S. Nemat-Nasser,
    J. Appl. Mech. 48 (1981) 339-344]. The symmetric part: what is left of the other turns the block. Weight acts at the centroid and adds
    nothing; loads at other points and what holds a block are not known here, so held blocks are nan, as are blocks that are not there.
    A result without contacts gives nan throughout."""
    stress = np.zeros((run.block_count, 2, 2))
    contacts = run.contacts(frame)
    if contacts:
        point = np.column_stack([contacts["x"], contacts["y"]])
        position = run.position(frame)
        on_b = contact_force(contacts)
        for block, force in ((contacts["block_a"], -on_b), (contacts["block_b"], on_b)):
            arm = point - position[block]
            for i in range(2):
                for j in range(2):
                    stress[:, i, j] -= np.bincount(block, force[:, i] * arm[:, j], minlength=run.block_count)
    stress = (stress + stress.transpose(0, 2, 1)) / (2 * run.blocks["area"][:, None, None])
    stress[run.blocks["held"].astype(bool) | run.removed(frame) | (not contacts)] = np.nan
    return stress


def contact_force(contacts) -> np.ndarray:
    """[contacts, 2] N per m, of block a on block b."""
    normal = np.column_stack([contacts["nx"], contacts["ny"]]).astype(float)
    along = np.column_stack([-normal[:, 1], normal[:, 0]])
    return normal * contacts["normal_force"][:, None] + along * contacts["shear_force"][:, None]


def principal(stress: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Major and minor principal stress [n] Pa, and the angle of the major one from +x [n] rad, of tensors [n, 2, 2]."""
    mean = (stress[:, 0, 0] + stress[:, 1, 1]) / 2
    half = (stress[:, 0, 0] - stress[:, 1, 1]) / 2
    radius = np.hypot(half, stress[:, 0, 1])
    return mean + radius, mean - radius, 0.5 * np.arctan2(stress[:, 0, 1], half)
