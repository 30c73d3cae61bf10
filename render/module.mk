# Styles, passes, pictures, kiosk: nothing yet.
