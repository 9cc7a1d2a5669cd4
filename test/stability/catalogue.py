"""The catalogue of hard cases: what makes each hard, what must hold. run.py runs it; doc/stability.md shows it.

What must hold for every case stands in judge.py. An entry adds its energy bound, and what is its own.
"""
import catalogue_steps  # noqa: F401  (each adds its entries)
import catalogue_cloth  # noqa: F401
import catalogue_bodies  # noqa: F401
import catalogue_world  # noqa: F401
from entry import ENTRIES  # noqa: F401
