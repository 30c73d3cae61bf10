#!/bin/sh
# gallery.sh BIN SITE FOLDER [check]: what parameters of hatching, filters and paint do, as contact sheets on one page: a knot that is made here, and the
# courtyard of the demo, or a smaller one where there is no demo site.
# check: only whether its sheets are what can be drawn.
set -e
bin=$1 court=$2 folder=$3 only=$4
here=$(dirname "$0")
started=$(date +%s)
arguments=$#
mkdir -p "$folder"

# Both sites stay, and are made again only when the mesh is another one.
if [ "$only" != check ]; then
	awk -f "$here/knot.awk" >"$folder/knot.new"
	if ! cmp -s "$folder/knot.new" "$folder/knot.off" || [ ! -f "$folder/knot/model/points.model" ]; then
		echo "gallery: a knotted tube becomes points"
		rm -rf "$folder/knot"
		mv "$folder/knot.new" "$folder/knot.off"
		"$bin/pleinair" import "$folder/knot" "$folder/knot.off" --samples 500000
		"$bin/pleinair" process "$folder/knot"
	fi
	rm -f "$folder/knot.new"
	if [ ! -f "$court/model/points.model" ]; then
		court=$folder/court
	fi
	if [ ! -f "$court/model/points.model" ]; then
		echo "gallery: two scans of the simulated courtyard (make demo makes a finer site)"
		rm -rf "$court"
		for station in 1 2; do
			"$bin/pleinair" scan "$court" --device "sim:court?seed=7&station=$station" --preset standard
		done
		"$bin/pleinair" process "$court"
	fi
fi

yard="site=$(basename "$court")"
# A style for each filter, over points in their own colours.
mkdir -p "$folder/filters"
filters=
for filter in kuwahara anisotropic-kuwahara bilateral gaussian gaps quantise dog edges watercolour flow oil pencil grade warp occlusion edl; do
	cat >"$folder/filters/$filter.json" <<END
{ "schema": 1, "paper": { "colour": "#fbf8f0", "grain": 0.1 }, "segments": { "site": { "steps": [ { "step": "points" } ] },
	"building": { "change": { "mask": { "backs": "hidden" } } }, "picture": { "steps": [ { "step": "$filter" } ] } } }
END
	filters=$filters${filters:+,}$folder/filters/$filter.json
done
filter() {
	printf '%s/filters/%s.json:view=walk;%s' "$folder" "$1" "$yard"
}

# One line a sheet: TITLE | CAPTION | what pleinair-styles(1) says of --sweep. knot: from near by; yard: the courtyard alone.
knot='site=knot;view="-3,-5,3.2:0.2,-0.6,1:22"'
coarse='light.azimuth_deg=100;hatching.spacing_px=12;hatching.length_px=64;hatching.width_px=4.5;hatching.opacity=1'
stout='hatching.spacing_px=6;hatching.length_px=44;hatching.width_px=3.4;hatching.opacity=1'
while read -r line; do
	[ -n "$line" ] && set -- "$@" --sweep "$line"
done <<END
All styles of hatching | What the shipped styles make of a smooth thing and of a place. Stands beside Figures 1 and 7. | pencil,charcoal,ballpoint,blueprint,chalk-on-black,coloured-crayons,wax-crayons,pointillism,two-colour
Line length | Strokes get longer, and with them the same surface darker. Section 3.1. | pencil:hatching.length_px=6,12,24,48
Line thickness | Strokes get broader. Section 3.1. | pencil:hatching.width_px=0.8,1.6,3.2,6.4
Line spacing | How far neighbouring strokes are apart where all of them are drawn; not in the paper, where points give it. | pencil:hatching.spacing_px=2,4,8,16
Stroke density | The part of all strokes that may be drawn. Section 3.1. | pencil:hatching.density=0.15,0.4,0.7,1
Parallel and crossed | None, some, or all strokes get a second one across them; where it is lighter they lose it first (h of section 3.5, interpolation of cross and parallel hatches). | pencil:$knot;$coarse;hatching.cross=0,0.33,0.66,1
Regular and irregular strokes | From strokes that are laid with a ruler to scattered ones. Stands beside Figure 3. | pencil:$knot;$coarse;hatching.cross=1;hatching.angle_variation_deg=0,8,25,60;hatching.length_variation=0,0.2,0.5,0.9;hatching.scatter=0,0.3,0.7,1
Line direction, across | The uniform vector of section 3.2 turns about the vertical; it is projected into every surface. | pencil:$stout;hatching.line_elevation_deg=0;hatching.line_azimuth_deg=0,45,90,135
Line direction, up | The uniform vector rises. | pencil:$stout;hatching.line_azimuth_deg=35;hatching.line_elevation_deg=0,30,60,90
Line angle | The same vector, strokes turned on their surfaces. | pencil:$stout;hatching.line_angle_deg=-45,0,45,90
Along the bends | One direction for all, or the one in which a surface is bent most. Beyond the paper, which has curvature for lengths alone. | ballpoint:hatching.follows=uniform,curvature
Light direction | The light goes around. Section 3.1. | pencil:light.azimuth_deg=30,120,210,300
Light from low to high | The light rises. | pencil:light.elevation_deg=0,30,60,90
Light and own tone | From the light alone, as on plaster, to points' own lightness alone. | pencil:light.amount=1,1,0.5,0;hatching.own_tone=0,0.5,1,1
Shine | Phong's highlight, stronger and smaller. Section 3.2. | ballpoint:$knot;light.azimuth_deg=320;light.elevation_deg=30;hatching.shine=0,0.5,1,2;hatching.shine_exponent=20,20,20,80
Colouring mode | One ink for all; the colours of the X-Toon texture; each point's own; both blended. Section 3.3. | coloured-crayons:hatching.pencils=[];hatching.colouring=ink,xtoon,point,blend
How much of which colour | Blended colours, from points' own to those of the X-Toon texture. Section 3.3. | coloured-crayons:hatching.pencils=[];hatching.mix=0,0.33,0.66,1
Hue shift | All hues turned. Section 3.1. | coloured-crayons:hatching.hue_shift_deg=-120,-60,0,60,120
X-Toon textures | Three textures, and all else the same. Stands beside Figure 2. | pencil:$stout;hatching.colouring=xtoon;hatching.xtoon=@pencil,@wax-crayons,@two-colour
X-Toon with depth | The texture's second way: a pencil that fades, and a crayon that turns blue, far away. Section 3.2; Figure 2 leaves it out. | pencil,$here/gallery/fading.json,$here/gallery/far-blue.json:$yard;hatching.far_m=30
Level of abstraction | Far away strokes are larger, and fewer. Section 5 wishes for it. | pencil:$yard;hatching.far_m=30;hatching.abstraction=0,1,2,4
Pencil boxes | The same picture with no box, and with 4, 8, 12 and 24 pencils; of two neighbours chance takes one. Section 3.3. | coloured-crayons:hatching.pencils=[],["#e0352b","#f7d51d","#2f9b45","#2354a4"],["#d81f2a","#f28a1d","#fbd914","#3ba53a","#159a92","#1f86c7","#5a3a98","#b0358c"],["#e6232a","#f0622d","#f7a823","#fbe122","#a5c72f","#2f9b45","#159a92","#2aa0d8","#2354a4","#5a3a98","#b0358c","#8a4b22"],["#d92121","#eb5523","#d97d21","#ebb923","#d9d921","#b9eb23","#7dd921","#55eb23","#21d921","#23eb55","#21d97d","#23ebb9","#21d9d9","#23b9eb","#217dd9","#2355eb","#2121d9","#5523eb","#7d21d9","#b923eb","#d921d9","#eb23b9","#d9217d","#eb2355"]
Pressure | Where few strokes are drawn they are faint too, or not. Alpha modification of section 3.5. | pencil:$knot;$coarse;hatching.pressure=0,0.33,0.66,1
Uneven pressure | No two strokes are of the same strength. Section 3.5. | pencil:$knot;$coarse;hatching.opacity_variation=0,0.3,0.6,1
Chance or darkness | The X-Toon's alpha as the part of the strokes that is drawn, or as how dark the surface becomes. | pencil:hatching.tone_by=chance,darkness
Curvature and length | Points alone, as dots; strokes of one length, which leave the surface where it is bent; strokes that are the shorter the more a surface is bent along them. Stands beside Figure 5. | stipple-diffuse,pencil,pencil:$knot;hatching.spacing_px=-,9,9;hatching.length_px=-,90,90;hatching.width_px=-,3.4,3.4;hatching.cross=-,1,1;hatching.curvature=-,0,4
Curvature, more of it | How much shorter strokes are in bends. | ballpoint:$knot;hatching.spacing_px=7;hatching.length_px=70;hatching.width_px=1.4;hatching.follows=curvature;hatching.curvature=0,0.5,1,4
Depth pass | Nothing is hidden; surface that is seen from behind; and what lies behind other surface. Stands beside Figure 6. | pencil:mask.disc=0,0,1.5;mask.backs=shown,hidden,hidden
Discs of the depth pass | How large points are when they hide others: too small lets through what is behind, too large eats what is beside. Section 3.4. | pencil:mask.disc=0.5,1,2,6
Offset of the depth pass | Without one discs eat strokes; too much lets through what is close behind. Stands beside Figure 4. | pencil:mask.offset_m=0,0.02,0.1,0.5;mask.offset_relative=0,0.004,0.004,0.004
Strokes' textures | What a stroke looks like by itself. Section 3.2. | pencil:$knot;light.azimuth_deg=100;hatching.spacing_px=20;hatching.length_px=90;hatching.width_px=10;hatching.opacity=1;hatching.texture=line,ink-pen,pencil,charcoal,chalk
The paper's grain in strokes | Not in the paper. | charcoal:$knot;light.azimuth_deg=100;hatching.tooth=0,0.33,0.66,1
The camera moves | Strokes stay where they are on the surface while the eye goes around it. Section 1, temporal coherence. | ballpoint:site=knot;view="-3,-5,3.2:0.2,-0.6,1:16","-2.9,-5.05,3.2:0.2,-0.6,1:16","-2.6,-5.2,3.2:0.2,-0.6,1:16","-2,-5.5,3.2:0.2,-0.6,1:16"
Contours | Outlines alone; with suggestive lines from curvature; and lines where the depth steps. Section 5 wishes for them. | ballpoint:hatching.density=0;edges.opacity=0;contours.opacity=1;contours.width_px=2;contours.outlines=1;contours.suggestive=0,1,1;contours.steps=0,0,1
Contours and abstraction | What is bent less than so has no lines. | ballpoint:$knot;hatching.density=0;edges.opacity=0;contours.opacity=1;contours.width_px=2;contours.steps=0;contours.bent_least_per_m=0.5,3,5,8
Stippling true to tones | Dots as dense as the X-Toon asks for, from lightest to darkest; by blue noise. Beyond the papers. | stippling:hatching.density=0.25,0.5,1
Dots that stay | They stay on the surface when the camera moves. Beyond the papers. | stippling:site=knot;view="-3,-5,3.2:0.2,-0.6,1:16","-2.9,-5.05,3.2:0.2,-0.6,1:16","-2.6,-5.2,3.2:0.2,-0.6,1:16"
Hidden points | Depths are spread to the pixels around once, twice, and as often as it takes. Stands beside Awano's Figure 12. | stipple-diffuse:site=knot;light.amount=0;stipple.passes=1,2,4,0
Diffuse reflection | The nearest point of each texel of the light's view is left out; finer texels leave out more. Stands beside Awano's Figure 13. | stipple-diffuse:site=knot;stipple.level=7,8,9,10
Specular reflection | Points whose share of the light's pixels is so much larger than of the eye's are left out. Stands beside Awano's Figure 14. | stipple-highlight:site=knot;stipple.epsilon=0,0.5,0.3,0.2
Shadows | What the light does not see stays whole. Stands beside Awano's Figure 15. | stipple-shadow:light.azimuth_deg=120,180,240;light.elevation_deg=35
The light of stippling | From where it comes, and from how near. Awano, section 2.2. | stipple-diffuse:site=knot;light.azimuth_deg=60,160,260,260;stipple.light_distance=0,0,0,1.5
Every filter | Each alone, as it is without anything said, over points in their own colours. | $filters:view=walk;$yard
Styles of filters | What the shipped styles make of them. Stands beside Wegen's Figures 1, 7, 8 and 10, Redmond's Figures 1, 3 and 4. | painterly,focus-place,focus-thing,watercolour-city,watercolour,ink-and-wash,cartoon,toon,posterised,oil,thick-oil,oil-edges,swimming,vegetation-map,pencil-sketch,woodcut,corners,model:view=walk;$yard
Compositing | Pictures of segments, laid on each other as they are listed; by depths of points, which lines beside things have none of; and with depths for them. Stands beside Wegen's Figure 12. | cartoon:view=walk;$yard;composite.by=layers,depth,inpainted-depth
Kuwahara, sampled regions | Of 3 x 3, 5 x 5, 9 x 9 and 17 x 17 pixels. Stands beside Redmond's Figures 1 and 2. | $(filter kuwahara);kuwahara.radius_px=2.4,4.8,9.6,19.2
Kuwahara, iterated | 3 x 3 once, twice, four and eight times. Redmond, section 3.1. | $(filter kuwahara);kuwahara.radius_px=2.4;kuwahara.passes=1,2,4,8
Kuwahara, hard and soft | The most even square alone, half of each, all weighted by how even they are. | $(filter kuwahara);kuwahara.radius_px=6;kuwahara.softness=0,0.5,1
Painted patches | Patches along the picture, larger and larger. | $(filter anisotropic-kuwahara);anisotropic-kuwahara.radius_px=3,6,10,16
Painted patches, round and long | From round ones to those that run along what is there. | $(filter anisotropic-kuwahara);anisotropic-kuwahara.radius_px=8;anisotropic-kuwahara.stretch=0,0.5,1
Even colours | The more colours differ that are smoothed. | $(filter bilateral);bilateral.sigma_tone=2,5,10,25
Steps of tone | Fewer and fewer; soft where lightness changes slowly, or hard. | $(filter quantise);quantise.levels=12,8,5,3;quantise.softness=0.65,0.65,0.65,0
Steps of tone, smoothed | Steps that smoothed lightness tells, and detail on them. | $(filter quantise);quantise.levels=6;quantise.softness=0.3;quantise.smooth_px=0,2,4,8
Poster | The same of red, green and blue each. | $(filter quantise);quantise.by=channels;quantise.softness=0;quantise.levels=8,6,4,2
Lines of the picture | How broad they are. Redmond, section 3.2. | $(filter dog);dog.sigma_px=0.7,1.2,2,3.5
Lines along the flow | Joined along what the picture shows, farther and farther. | $(filter dog);dog.alone=true;dog.sigma_px=1.4;dog.flow_px=0,2,5,10
Filled with black | Sharpness fills what is dark. | $(filter dog);dog.alone=true;dog.flow_px=4;dog.contrast=14;dog.threshold=0.45;dog.sharpness=4,10,20,50
Edges of things | By depth alone, with bends, and where segments meet. | $(filter edges);edges.segments=false,false,true;edges.bend_deg=0,40,40
Edges, wider and unsteady | A broad pen, and a hand that trembles. | $(filter edges);edges.width_px=1,3,6,3;edges.wobble_px=0,0,0,5
Watercolour | Without wobbling; without dark edges; with more turbulence; grainy. | $(filter watercolour);watercolour.wobble_px=0,3,3,3;watercolour.darkening=1,0,1,1;watercolour.turbulence=0.5,0.5,1.5,0.5;watercolour.grain=0.5,0.5,0.5,1.5
Oil | Bristles, broader and thicker. | $(filter oil);oil.width_px=1.5,3,5,8;oil.relief=0.4,0.8,1.2,2
Colours drawn out | Along what the picture shows. | $(filter flow);flow.length_px=4,12,24,48
Pencil | Layers on each other. | $(filter pencil);pencil.layers=1,2,4,6
Colour grading | Warmer; greyer; tinted; each segment its own. | $(filter grade);grade.warmth=0.8,0,0,0;grade.saturation=1,0.2,1,1;grade.tint=-,-,"#3a6ea5",-;grade.tint_amount=0,0,0.9,0;grade.segments=0,0,0,0.9
Swaying | Farther and farther. Stands beside Wegen's Figure 11. | $(filter warp);warp.amplitude_px=0,12,24,40
Shade in corners | Farther and farther around. | $(filter occlusion);occlusion.radius_m=0.2,0.6,1.5,4
Closed gaps | Wider and wider ones. | $(filter gaps);gaps.radius_px=1,3,6,10
Focus on a place | Patches grow and edges fade with the distance from it. Stands beside Redmond's Figure 3. | focus-place:view=walk;$yard;focus.amount=0,0,0.5,0.9;focus.across=0.25,0.7,0.7,0.5
Profile lines | The shipped styles of long lines. Xu & Chen wish for them in section 9. | line-drawing,construction-lines:view=walk;$yard
Which lines are left | Fewer and fewer: the long ones, and those that nothing runs beside. | line-drawing:view=walk;$yard;lines.least_px=4,14,50,120;lines.room_px=1,7,20,40
The hand | From a ruler to a hand that strays; and a pen that presses. | line-drawing:view=walk;$yard;lines.wobble_px=0,0.7,2,4;lines.pressure=0,0.35,0.7,1
Outlines | How much broader lines are where surface ends. | line-drawing:view=walk;$yard;lines.outlines=1,1.8,3,5
Hidden parts | Left out, and as dots. | construction-lines:view=walk;$yard;lines.hidden=0,0.4,0.9
Paint | The shipped styles of brush strokes. Xu & Chen wish for them in section 9. | impressionist,gouache,ink-and-paint,line-over-paint:view=walk;$yard
Broad strokes | The broadest strokes get larger, and all others with them. | impressionist:view=walk;$yard;paint.length_px=20,40,80,140;paint.width_px=6,11,22,38
Fine strokes | How large the finest are, as a part of the broadest; and who has them: all, or only what has details. | impressionist:view=walk;$yard;paint.fine=1,0.4,0.15,0.15;paint.detail=1,1,1,0
Cover | How much paint there is, from the ground that shows to none of it. | gouache:view=walk;$yard;paint.cover=0.4,1,2,5
Gaps | How far paper between strokes takes the colour of the paint beside it. | impressionist:view=walk;$yard;paint.cover=0.8,0.8,0.8;paint.gap_px=0,6,24
Following the form | Strokes that are level everywhere, and strokes that go along edges and bends. | impressionist:view=walk;$yard;paint.follow=0,1
Wet and dry | Strokes that hide each other, and that mix. | impressionist:view=walk;$yard;paint.wet=0,0.5,1
Thickness | What light makes of paint that lies thick. | impressionist:view=walk;$yard;paint.thickness_px=0,2,6;paint.shine=0,0.1,0.3
Focus on a thing | One segment is as it is: buildings, vegetation, structures. Stands beside Redmond's Figure 4. | focus-thing:view=walk;$yard;focus.segment=3,4,6
END
shift $arguments
if [ "$only" = check ]; then
	"$bin/pleinair" styles --check "$@"
	exit
fi
echo "gallery: drawing a sheet for each of $(($# / 2)) parameters"
"$bin/pleinair" styles "$folder/knot" "$court" "$@" --output "$folder/sheets"
echo
echo "gallery: done in $(($(date +%s) - started)) s. Look at:"
echo "    $(cd "$folder" && pwd)/sheets/index.html"
