# Gives the meshes of a baked GLB their shader. Choose this script as "Import Script" in the Import dock.
#
# The material is stored beside the asset, NAME.glb -> NAME_cloud.tres, so that you can edit it: later imports change only k, b, sigma
# and the UV sets. An impostor (`cloudbake impostor`) gets a square with the shader cloudbake_impostor, and its pictures are stored beside
# it. A sequence (`cloudbake sequence --as picture`) gets the shader and the script cloudbake_sequence, and its picture is stored beside
# it.
# Import settings that keep the lobes: Meshes > Force Disable Compression on, Ensure Tangents off, Light Baking not "Static Lightmaps"
# (which replaces UV2). A sequence also needs Generate LODs off.
@tool
extends EditorScenePostImport

const GLB = 0x46546C67
const FLOAT_MAX = 3.4028234e38  # shaders have 32 bits
const KEY_COLUMNS = 1024    # of the picture of a sequence
# What a surface has if it has a UV set: 0, 1 and up.
const FORMATS = [
	Mesh.ARRAY_FORMAT_TEX_UV, Mesh.ARRAY_FORMAT_TEX_UV2, Mesh.ARRAY_FORMAT_CUSTOM0, Mesh.ARRAY_FORMAT_CUSTOM0,
	Mesh.ARRAY_FORMAT_CUSTOM1, Mesh.ARRAY_FORMAT_CUSTOM1, Mesh.ARRAY_FORMAT_CUSTOM2, Mesh.ARRAY_FORMAT_CUSTOM2,
]


func _post_import(scene):
	var document = _document()
	var info = document.get("asset", {}).get("extras", {}).get("cloudbake", {})
	if info.get("layout") == "lobe-impostor":
		_set_impostor(scene, _square(info), _impostor_material(info, document))
		return scene
	if info.get("layout") == "lobe-sequence":
		_set_sequence(scene, info, document)
		return scene
	if info.is_empty():
		push_warning("%s has no extras.cloudbake: k, b and sigma are those of the shader." % get_source_file())
	var first_set = int(info.get("uv_sets", [0, 1])[0])
	_set_material(scene, _material(info, first_set), FORMATS[first_set + 1], int(info.get("switch_pixels", 0)))
	return scene


# The JSON of the GLB; empty if the asset is something else.
func _document():
	var file = FileAccess.open(get_source_file(), FileAccess.READ)
	if file == null or file.get_32() != GLB:
		return {}
	file.seek(12)
	var size = file.get_32()
	file.seek(20)
	return JSON.parse_string(file.get_buffer(size).get_string_from_utf8())


func _material(info, first_set):
	var path = get_source_file().get_basename() + "_cloud.tres"
	var material = load(path) if ResourceLoader.exists(path) else ShaderMaterial.new()
	var folder = get_script().resource_path.get_base_dir()
	if not material.shader or not material.shader.resource_path.begins_with(folder):    # keeps the choice of another shader of the kit
		material.shader = load(folder + "/cloudbake.gdshader")
	for parameter in ["exponent", "bias", "extinction"]:
		if not parameter in info:
			continue
		if typeof(info[parameter]) != TYPE_FLOAT or abs(info[parameter]) > FLOAT_MAX:
			push_error("%s: extras.cloudbake.%s is %s, not a number of 32 bits: bake it again." % [get_source_file(), parameter, info[parameter]])
			continue
		material.set_shader_parameter(parameter, info[parameter])
	material.set_shader_parameter("first_set", first_set)
	material.set_shader_parameter("density_max", float(info.get("density_max", 0)))    # of a packed asset
	material.set_shader_parameter("of_volume", 1.0 if info.get("fit_to") == "volume" else 0.0)
	ResourceSaver.save(material, path)
	material.take_over_path(path)
	return material


func _impostor_material(info, document):
	var path = get_source_file().get_basename() + "_cloud.tres"
	var material = load(path) if ResourceLoader.exists(path) else ShaderMaterial.new()
	material.shader = load(get_script().resource_path.get_base_dir() + "/cloudbake_impostor.gdshader")
	for parameter in ["exponent", "extinction"]:
		material.set_shader_parameter(parameter, info[parameter])
	material.set_shader_parameter("of_volume", 1.0 if info.get("gains") else 0.0)
	material.set_shader_parameter("impostor_center", Vector3(info.center[0], info.center[1], info.center[2]))
	material.set_shader_parameter("impostor_radius", info.radius)
	var last_level = 0
	var side = int(info.frame)
	while side % 2 == 0 and side >= 8:
		side /= 2
		last_level += 1
	material.set_shader_parameter("impostor_atlas", Vector4(info.views, info.frame, last_level, info.thickest))
	for picture in ["lobe", "rest"]:
		material.set_shader_parameter("impostor_" + picture, _picture(picture, document, true))
	ResourceSaver.save(material, path)
	material.take_over_path(path)
	return material


# A picture of the asset.
func _picture(wanted, document, has_levels):
	for picture in document.images:
		if picture.get("name") != wanted:
			continue
		var view = document.bufferViews[int(picture.bufferView)]
		var file = FileAccess.open(get_source_file(), FileAccess.READ)
		file.seek(12)
		file.seek(28 + file.get_32() + int(view.get("byteOffset", 0)))
		var image = Image.new()
		image.load_png_from_buffer(file.get_buffer(int(view.byteLength)))
		if has_levels:
			image.generate_mipmaps()
		var texture = ImageTexture.create_from_image(image)
		var path = "%s_%s.res" % [get_source_file().get_basename(), wanted]
		ResourceSaver.save(texture, path)
		texture.take_over_path(path)
		return texture
	push_error("%s has lost its picture '%s': take the file that cloudbake wrote." % [get_source_file(), wanted])
	return null


# A square whose bounds are those of the ball; the shader turns it.
func _square(info):
	var arrays = []
	arrays.resize(Mesh.ARRAY_MAX)
	arrays[Mesh.ARRAY_VERTEX] = PackedVector3Array([Vector3(-1, -1, 0), Vector3(1, -1, 0), Vector3(1, 1, 0), Vector3(-1, 1, 0)])
	arrays[Mesh.ARRAY_INDEX] = PackedInt32Array([0, 1, 2, 0, 2, 3])
	var mesh = ArrayMesh.new()
	mesh.add_surface_from_arrays(Mesh.PRIMITIVE_TRIANGLES, arrays)
	var center = Vector3(info.center[0], info.center[1], info.center[2])
	mesh.custom_aabb = AABB(center - Vector3.ONE * info.radius, 2 * Vector3.ONE * info.radius)
	return mesh


func _set_impostor(node, square, material):
	if node is MeshInstance3D:
		square.surface_set_material(0, material)
		node.mesh = square
		node.set_surface_override_material(0, null)
		node.add_to_group("cloudbake", true)
		node.set_meta("impostor", true)    # cloudbake_painted.gd leaves it to the engine
	for child in node.get_children():
		_set_impostor(child, square, material)


func _set_material(node, material, format, switch_pixels):
	if node is MeshInstance3D and node.mesh:
		for surface in node.mesh.get_surface_count():
			if node.mesh.surface_get_format(surface) & format:
				node.mesh.surface_set_material(surface, material)
				node.add_to_group("cloudbake", true)
				node.set_meta("switch_pixels", switch_pixels)    # of a level of detail; cloudbake_levels.gd reads it
	for child in node.get_children():
		_set_material(child, material, format, switch_pixels)


# The keys are in the picture, and each vertex has its texel in CUSTOM0. Segments are shown and hidden by cloudbake_sequence.gd.
func _set_sequence(scene, info, document):
	if info.sequence.keys != "picture":
		push_error("%s has its keys as morph targets: write it with `cloudbake sequence --as picture`." % get_source_file())
		return
	var low = info.sequence.box[0]
	var high = info.sequence.box[1]
	var box = AABB(Vector3(low[0], low[1], low[2]), Vector3(high[0] - low[0], high[1] - low[1], high[2] - low[2]))
	var material = _sequence_material(info, box, document)
	var numbers = []
	_collect_meshes(document, document.scenes[int(document.get("scene", 0))].get("nodes", []), numbers)
	var instances = []
	_collect_instances(scene, instances)
	for i in info.sequence.segments.size():
		var segment = info.sequence.segments[i]
		_set_segment(instances[numbers.find(int(segment.mesh))], i, segment, box, material)
	for child in scene.get_children():
		if child is AnimationPlayer:    # it would show and hide the segments, for programs without fades
			scene.remove_child(child)
			child.free()
	scene.set_script(load(get_script().resource_path.get_base_dir() + "/cloudbake_sequence.gd"))
	scene.set_meta("sequence", info.sequence)


func _set_segment(node, number, segment, box, material):
	var rows = ceil(node.mesh.surface_get_array_len(0) / float(KEY_COLUMNS))
	node.set_meta("sequence_segment", number)
	node.set_meta("sequence_place", Vector3(segment.first_row, rows, segment.frames.size()))
	node.transform = Transform3D(Basis(), node.position)    # the file scales what is not seen by 0
	node.visible = number == 0
	node.mesh.custom_aabb = box
	node.mesh.surface_set_material(0, material)
	node.cast_shadow = GeometryInstance3D.SHADOW_CASTING_SETTING_OFF    # meshes for shadows have no texels
	node.add_to_group("cloudbake", true)


func _sequence_material(info, box, document):
	var material = _material(info, 0)
	material.shader = load(get_script().resource_path.get_base_dir() + "/cloudbake_sequence.gdshader")
	material.set_shader_parameter("sequence_keys", _picture("keys", document, false))
	material.set_shader_parameter("sequence_low", box.position)
	material.set_shader_parameter("sequence_high", box.end)
	material.set_shader_parameter("sequence_densest", info.sequence.density_max)
	ResourceSaver.save(material, material.resource_path)
	return material


func _collect_meshes(document, nodes, found):
	for number in nodes:
		var node = document.nodes[int(number)]
		if node.has("mesh"):
			found.append(int(node.mesh))
		_collect_meshes(document, node.get("children", []), found)


func _collect_instances(node, found):
	if node is MeshInstance3D and node.mesh:
		found.append(node)
	for child in node.get_children():
		_collect_instances(child, found)
