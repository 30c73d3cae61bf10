# Styles, passes, pictures, kiosk; and the commands that need every folder.
programs += render/pleinair-bench render/pleinair-styles
# What programs find in ../share/pleinair.
shared += render/style.schema.json $(wildcard render/styles/*.json)
