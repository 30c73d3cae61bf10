# Styles, passes, pictures, kiosk; and the commands that need every folder.
programs += render/pleinair-bench
