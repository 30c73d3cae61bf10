# Wires, stage, camera, and the record of what they said.
