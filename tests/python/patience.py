"""How long these tests wait."""

# Seconds that anything is waited for before it counts as lost. Nothing takes so long on any computer.
PATIENCE = 300
