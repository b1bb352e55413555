# SPDX-License-Identifier: MIT
"""Deliberate mistakes, each of which at least one test must notice. tests/mutants/run.py makes them one at a time."""
import mutants_of_engine
import mutants_of_files
import mutants_of_levels
import mutants_of_operators
import mutants_of_parts
import mutants_of_runs

MUTANTS = (mutants_of_operators.MUTANTS + mutants_of_engine.MUTANTS + mutants_of_files.MUTANTS + mutants_of_levels.MUTANTS + mutants_of_parts.MUTANTS
           + mutants_of_runs.MUTANTS)
