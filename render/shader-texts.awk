# Makes C of the files in shaders/: gles_shaders of gles-shaders.h.
BEGIN { print "#include \"render/gles-shaders.h\"\n\nconst struct gles_shader gles_shaders[] = {" }
FNR == 1 {
	name = FILENAME
	sub(/.*\//, "", name)
	sub(/\.glsl$/, "", name)
	printf "%s\t{ \"%s\",\n", (NR == 1) ? "" : "\t},\n", name
}
{
	gsub(/\\/, "&&")
	gsub(/"/, "\\\"")
	printf "\t\"%s\\n\"\n", $0
}
END { print "\t},\n\t{ NULL, NULL },\n};" }
