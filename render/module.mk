# Styles, passes, pictures, kiosk; and the commands that need every folder.
programs += render/pleinair-bench
# What programs find in ../share/pleinair.
shared += render/style.schema.json $(wildcard render/styles/*.json)
