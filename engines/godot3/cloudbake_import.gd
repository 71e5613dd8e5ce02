# Gives the meshes of a baked GLB their shader. Choose this script as "Custom Script" in the Import dock.
#
# The material is stored beside the asset, NAME.glb -> NAME_cloud.tres, so that you can edit it: later imports change only k, b and sigma.
# An impostor (`cloudbake impostor`) gets a square with the shader cloudbake_impostor, and its pictures are stored beside it. A sequence
# (`cloudbake sequence --as picture`) gets the shader and the script cloudbake_sequence, and its picture is stored beside it.
# Import settings that keep the lobes: Meshes > Compress off, Ensure Tangents off, Light Baking not "Gen Lightmaps" (which replaces UV2).
tool
extends EditorScenePostImport

const FLOAT = 5126
const SHORT = 5122
const UNSIGNED_SHORT = 5123
const GLB = 0x46546C67
const FLOAT_MAX = 3.4028234e38  # shaders have 32 bits
const KEY_COLUMNS = 1024    # of the picture of a sequence


func post_import(scene):
	var file = File.new()
	var document = _document(file)
	var info = document.get("asset", {}).get("extras", {}).get("cloudbake", {})
	if info.get("layout") == "lobe-impostor":
		_set_impostor(scene, _square(info), _impostor_material(info, document, file))
		return scene
	if info.get("layout") == "lobe-sequence":
		_set_sequence(scene, info, document, file)
		return scene
	var first_set = int(info.get("uv_sets", [0, 1])[0])
	if info.empty():
		push_warning("%s has no extras.cloudbake: k, b and sigma are those of the shader." % get_source_file())
	# Godot stores the sets that it reads itself as half floats, which are too coarse for packed lobes.
	var is_packed = info.get("layout") == "lobe-packed"
	if (first_set != 0 or is_packed) and not _move_sets(scene, document, file, [first_set, first_set + 1]):
		push_error("%s has its lobes in the UV sets %d and %d. They cannot be brought to UV and UV2: the clouds get no shader." %
				[get_source_file(), first_set, first_set + 1])
		return scene
	_set_material(scene, _material(info), int(info.get("switch_pixels", 0)))
	return scene


# The JSON of the GLB; empty if the asset is something else.
func _document(file):
	if file.open(get_source_file(), File.READ) != OK or file.get_32() != GLB:
		return {}
	file.seek(12)
	var size = file.get_32()
	file.seek(20)
	return JSON.parse(file.get_buffer(size).get_string_from_utf8()).result


func _material(info):
	var path = get_source_file().get_basename() + "_cloud.tres"
	var material = load(path) if ResourceLoader.exists(path) else ShaderMaterial.new()
	var folder = get_script().resource_path.get_base_dir()
	if not material.shader or not material.shader.resource_path.begins_with(folder):    # keeps the choice of another shader of the kit
		material.shader = load(folder + "/cloudbake.shader")
	for name in ["exponent", "bias", "extinction"]:
		if not name in info:
			continue
		if typeof(info[name]) != TYPE_REAL or abs(info[name]) > FLOAT_MAX:
			push_error("%s: extras.cloudbake.%s is %s, not a number of 32 bits: bake it again." % [get_source_file(), name, info[name]])
			continue
		material.set_shader_param(name, info[name])
	material.set_shader_param("density_max", float(info.get("density_max", 0)))    # of a packed asset
	material.set_shader_param("of_volume", 1.0 if info.get("fit_to") == "volume" else 0.0)
	ResourceSaver.save(path, material)
	material.take_over_path(path)
	return material


func _impostor_material(info, document, file):
	var path = get_source_file().get_basename() + "_cloud.tres"
	var material = load(path) if ResourceLoader.exists(path) else ShaderMaterial.new()
	material.shader = load(get_script().resource_path.get_base_dir() + "/cloudbake_impostor.shader")
	for name in ["exponent", "extinction"]:
		material.set_shader_param(name, info[name])
	material.set_shader_param("of_volume", 1.0 if info.get("gains") else 0.0)
	material.set_shader_param("impostor_center", Vector3(info.center[0], info.center[1], info.center[2]))
	material.set_shader_param("impostor_radius", info.radius)
	var last_level = 0
	var side = int(info.frame)
	while side % 2 == 0 and side >= 8:
		side /= 2
		last_level += 1
	material.set_shader_param("impostor_atlas", Plane(info.views, info.frame, last_level, info.thickest))
	for name in ["lobe", "rest"]:
		material.set_shader_param("impostor_" + name, _picture(name, document, file, Texture.FLAG_FILTER | Texture.FLAG_MIPMAPS))
	ResourceSaver.save(path, material)
	material.take_over_path(path)
	return material


# A picture of the asset, clamped.
func _picture(name, document, file, flags):
	var texture = ImageTexture.new()
	for picture in document.images:
		if picture.get("name") != name:
			continue
		var view = document.bufferViews[int(picture.bufferView)]
		file.seek(12)
		file.seek(28 + file.get_32() + int(view.get("byteOffset", 0)))
		var image = Image.new()
		image.load_png_from_buffer(file.get_buffer(int(view.byteLength)))
		if flags & Texture.FLAG_MIPMAPS:
			image.generate_mipmaps()
		texture.create_from_image(image, flags)
		var path = "%s_%s.res" % [get_source_file().get_basename(), name]
		ResourceSaver.save(path, texture)
		texture.take_over_path(path)
		return texture
	push_error("%s has lost its picture '%s': take the file that cloudbake wrote." % [get_source_file(), name])
	return texture


# A square whose bounds are those of the ball; the shader turns it.
func _square(info):
	var arrays = []
	arrays.resize(Mesh.ARRAY_MAX)
	arrays[Mesh.ARRAY_VERTEX] = PoolVector3Array([Vector3(-1, -1, 0), Vector3(1, -1, 0), Vector3(1, 1, 0), Vector3(-1, 1, 0)])
	arrays[Mesh.ARRAY_INDEX] = PoolIntArray([0, 1, 2, 0, 2, 3])
	var mesh = ArrayMesh.new()
	mesh.add_surface_from_arrays(Mesh.PRIMITIVE_TRIANGLES, arrays)
	var center = Vector3(info.center[0], info.center[1], info.center[2])
	mesh.custom_aabb = AABB(center - Vector3.ONE * info.radius, 2 * Vector3.ONE * info.radius)
	return mesh


func _set_impostor(node, square, material):
	if node is MeshInstance:
		square.surface_set_material(0, material)
		node.mesh = square
		node.set_surface_material(0, null)
		node.add_to_group("cloudbake", true)
		node.set_meta("impostor", true)    # cloudbake_painted.gd leaves it to the engine
	for child in node.get_children():
		_set_impostor(child, square, material)


func _set_material(node, material, switch_pixels):
	if node is MeshInstance and node.mesh:
		for surface in node.mesh.get_surface_count():
			if node.mesh.surface_get_format(surface) & Mesh.ARRAY_FORMAT_TEX_UV2:
				node.mesh.surface_set_material(surface, material)
				node.set_surface_material(surface, null)
				node.add_to_group("cloudbake", true)
				node.set_meta("switch_pixels", switch_pixels)    # of a level of detail; cloudbake_levels.gd reads it
	for child in node.get_children():
		_set_material(child, material, switch_pixels)


# The keys are in the picture, and each vertex has its texel in UV. Segments are shown and hidden by cloudbake_sequence.gd.
func _set_sequence(scene, info, document, file):
	if info.sequence.keys != "picture":
		push_error("%s has its keys as morph targets: write it with `cloudbake sequence --as picture`." % get_source_file())
		return
	if not _move_sets(scene, document, file, [2, 2]):
		push_error("%s has lost its UV set 2: take the file that `cloudbake sequence` wrote." % get_source_file())
		return
	var low = info.sequence.box[0]
	var high = info.sequence.box[1]
	var box = AABB(Vector3(low[0], low[1], low[2]), Vector3(high[0] - low[0], high[1] - low[1], high[2] - low[2]))
	var material = _sequence_material(info, box, document, file)
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
	node.transform = Transform(Basis(), node.translation)    # the file scales what is not seen by 0
	node.visible = number == 0
	node.mesh.custom_aabb = box
	node.mesh.surface_set_material(0, material)
	node.set_surface_material(0, null)
	node.add_to_group("cloudbake", true)


func _sequence_material(info, box, document, file):
	var material = _material(info)
	material.shader = load(get_script().resource_path.get_base_dir() + "/cloudbake_sequence.shader")
	material.set_shader_param("sequence_keys", _picture("keys", document, file, 0))
	material.set_shader_param("sequence_low", box.position)
	material.set_shader_param("sequence_high", box.end)
	material.set_shader_param("sequence_densest", info.sequence.density_max)
	ResourceSaver.save(material.resource_path, material)
	return material


# Godot 3 reads the UV sets 0 and 1 alone. This reads two others from the GLB and stores them in their place.
func _move_sets(scene, document, file, sets):
	var shown = []  # the numbers of the meshes of the nodes, in the order of the scene
	_collect_meshes(document, document.scenes[int(document.get("scene", 0))].get("nodes", []), shown)
	var instances = []
	_collect_instances(scene, instances)
	if document.has("skins") or shown.size() != instances.size():
		return false
	for i in shown.size():
		var primitives = document.meshes[shown[i]].primitives
		if primitives.size() != instances[i].mesh.get_surface_count():
			return false
		if not _move_sets_of(instances[i].mesh, primitives, document, file, sets):
			return false
	return true


func _collect_meshes(document, nodes, found):
	for number in nodes:
		var node = document.nodes[int(number)]
		if node.has("mesh"):
			found.append(int(node.mesh))
		_collect_meshes(document, node.get("children", []), found)


func _collect_instances(node, found):
	if node is MeshInstance and node.mesh:
		found.append(node)
	for child in node.get_children():
		_collect_instances(child, found)


func _move_sets_of(mesh, primitives, document, file, sets):
	var surfaces = []
	for s in primitives.size():
		var arrays = mesh.surface_get_arrays(s)
		for i in 2:
			var values = _uv_set(document, file, primitives[s].attributes.get("TEXCOORD_%d" % sets[i]))
			if values.size() != arrays[Mesh.ARRAY_VERTEX].size():
				return false
			arrays[Mesh.ARRAY_TEX_UV if i == 0 else Mesh.ARRAY_TEX_UV2] = values
		surfaces.append([mesh.surface_get_primitive_type(s), arrays, mesh.surface_get_blend_shape_arrays(s)])
	while mesh.get_surface_count() > 0:
		mesh.surface_remove(0)
	for surface in surfaces:
		mesh.add_surface_from_arrays(surface[0], surface[1], surface[2], 0)
	return true


func _uv_set(document, file, number):
	var values = PoolVector2Array()
	var type = 0 if number == null else int(document.accessors[int(number)].componentType)
	if not type in [FLOAT, SHORT, UNSIGNED_SHORT]:
		return values
	var accessor = document.accessors[int(number)]
	var view = document.bufferViews[int(accessor.bufferView)]
	file.seek(12)
	var at = 28 + file.get_32() + int(view.get("byteOffset", 0)) + int(accessor.get("byteOffset", 0))
	for i in int(accessor.count):
		file.seek(at + i * int(view.get("byteStride", 8 if type == FLOAT else 4)))
		var u = _number(file, type)
		values.append(Vector2(u, _number(file, type)))
	return values


# Packed assets have normalised whole numbers.
func _number(file, type):
	if type == FLOAT:
		return file.get_float()
	var whole = file.get_16()
	if type == UNSIGNED_SHORT:
		return whole / 65535.0
	return max((whole - 65536 if whole > 32767 else whole) / 32767.0, -1.0)
