//! Reset and emergency stop at any tick: together, in phase, and nothing comes later.
