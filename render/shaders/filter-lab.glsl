/* CIELab (D65) of bytes of sRGB, and back (filter_to_lab, filter_of_lab). */
layout(binding = 5) uniform sampler2D srgb_bytes; /* 64 x 64 steps of light */

vec3 lab_of(uint rgba)
{
	const mat3 to_xyz = mat3(0.4124564 / 0.95047, 0.2126729, 0.0193339 / 1.08883,
		0.3575761 / 0.95047, 0.7151522, 0.1191920 / 1.08883,
		0.1804375 / 0.95047, 0.0721750, 0.9503041 / 1.08883);
	vec3 t = clamp(to_xyz * light_of_bytes(rgba), 0.0, 1.0);
	vec3 root = pow(max(t, vec3(1e-6)), vec3(1.0 / 3.0)), line = (24389.0 / 27.0 * t + 16.0) / 116.0;
	vec3 f = mix(line, root, greaterThan(t, vec3(216.0 / 24389.0)));
	return vec3(116.0 * f.y - 16.0, 500.0 * (f.x - f.y), 200.0 * (f.y - f.z));
}

uint rgba_of_lab(vec3 lab)
{
	const mat3 of_xyz = mat3(3.2404542 * 0.95047, -0.9692660 * 0.95047, 0.0556434 * 0.95047,
		-1.5371385, 1.8760108, -0.2040259,
		-0.4985314 * 1.08883, 0.0415560 * 1.08883, 1.0572252 * 1.08883);
	float y = (lab.x + 16.0) / 116.0;
	vec3 f = vec3(y + lab.y / 500.0, y, y - lab.z / 200.0), cube = f * f * f;
	vec3 xyz = mix((116.0 * f - 16.0) * (27.0 / 24389.0), cube, greaterThan(cube, vec3(216.0 / 24389.0)));
	ivec3 n = ivec3(clamp(of_xyz * xyz, 0.0, 1.0) * 4095.0 + 0.5);
	vec3 rgb;
	for (int k = 0; k < 3; k++)
		rgb[k] = texelFetch(srgb_bytes, ivec2(n[k] & 63, n[k] >> 6), 0).r * 255.0;
	return rgba_of(rgb);
}
