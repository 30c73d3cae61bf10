# Registration, geometry, segments, features, model: nothing yet.
