# awk -f knot.awk > knot.off: a closed mesh that hatching is looked at on. A tube is tied to a trefoil knot; along it it swells and
# narrows, and bumps run around it, so that it is bent in all ways and hides parts of itself; its inside is never seen.
# ALONG and AROUND are how many vertices it has (-v ALONG=60 -v AROUND=12 makes a small one).
function curve(t, ret) {
	ret[0] = (1.25 + 0.55 * cos(3 * t)) * cos(2 * t + 1.2)
	ret[1] = (1.25 + 0.55 * cos(3 * t)) * sin(2 * t + 1.2)
	ret[2] = 1 + 0.6 * sin(3 * t)
}
function unit(v,    length_) {
	length_ = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
	for (k = 0; k < 3; k++)
		v[k] /= length_
}
function cross(a, b, ret) {
	for (k = 0; k < 3; k++)
		ret[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3]
	unit(ret)
}
# The tube's radius; only whole numbers of waves, so that both ends meet.
function radius(t, v) {
	return 0.3 + 0.06 * sin(9 * t) + 0.02 * sin(40 * t) * cos(5 * v + 6 * t)
}
# At the place t of the curve: side and up stand on it and on each other.
function frame(t, at, side, up,    ahead, along, k) {
	curve(t, at)
	curve(t + 1e-5, ahead)
	for (k = 0; k < 3; k++)
		along[k] = ahead[k] - at[k]
	unit(along)
	cross(along, vertical, side)
	cross(side, along, up)
}
function ring(t,    at, side, up, j, v, r, k) {
	frame(t, at, side, up)
	for (j = 0; j < AROUND; j++) {
		v = turn * j / AROUND
		r = radius(t, v)
		for (k = 0; k < 3; k++)
			printf "%.6f%s", at[k] + r * (cos(v) * side[k] + sin(v) * up[k]), k < 2 ? " " : "\n"
	}
}
# Both triangles of a cell, counterclockwise as they are seen from outside.
function cell(i, j,    a, b, c, d) {
	a = i * AROUND + j
	b = (i + 1) % ALONG * AROUND + j
	c = (i + 1) % ALONG * AROUND + (j + 1) % AROUND
	d = i * AROUND + (j + 1) % AROUND
	print 3, a, b, c
	print 3, a, c, d
}
BEGIN {
	turn = 8 * atan2(1, 1)
	ALONG = ALONG ? ALONG : 900
	AROUND = AROUND ? AROUND : 80
	vertical[0] = vertical[1] = 0
	vertical[2] = 1
	print "OFF"
	print ALONG * AROUND, 2 * ALONG * AROUND, 0
	for (i = 0; i < ALONG; i++)
		ring(turn * i / ALONG)
	for (i = 0; i < ALONG; i++)
		for (j = 0; j < AROUND; j++)
			cell(i, j)
}
