# Gives the meshes of a baked GLB their shader. Choose this script as "Import Script" in the Import dock.
#
# The material is stored beside the asset, NAME.glb -> NAME_cloud.tres, so that you can edit it: later imports change only k, b, sigma
# and the UV sets. Import settings that keep the lobes: Meshes > Force Disable Compression on, Ensure Tangents off, Light Baking not
# "Static Lightmaps" (which replaces UV2).
@tool
extends EditorScenePostImport

const GLB = 0x46546C67
const FLOAT_MAX = 3.4028234e38  # shaders have 32 bits
# What a surface has if it has a UV set: 0, 1 and up.
const FORMATS = [
	Mesh.ARRAY_FORMAT_TEX_UV, Mesh.ARRAY_FORMAT_TEX_UV2, Mesh.ARRAY_FORMAT_CUSTOM0, Mesh.ARRAY_FORMAT_CUSTOM0,
	Mesh.ARRAY_FORMAT_CUSTOM1, Mesh.ARRAY_FORMAT_CUSTOM1, Mesh.ARRAY_FORMAT_CUSTOM2, Mesh.ARRAY_FORMAT_CUSTOM2,
]


func _post_import(scene):
	var info = _info()
	if info.is_empty():
		push_warning("%s has no extras.cloudbake: k, b and sigma are those of the shader." % get_source_file())
	var first_set = int(info.get("uv_sets", [0, 1])[0])
	_set_material(scene, _material(info, first_set), FORMATS[first_set + 1], int(info.get("switch_pixels", 0)))
	return scene


# asset.extras.cloudbake of the GLB; empty if the asset is something else.
func _info():
	var file = FileAccess.open(get_source_file(), FileAccess.READ)
	if file == null or file.get_32() != GLB:
		return {}
	file.seek(12)
	var size = file.get_32()
	file.seek(20)
	var document = JSON.parse_string(file.get_buffer(size).get_string_from_utf8())
	return document.get("asset", {}).get("extras", {}).get("cloudbake", {})


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


func _set_material(node, material, format, switch_pixels):
	if node is MeshInstance3D and node.mesh:
		for surface in node.mesh.get_surface_count():
			if node.mesh.surface_get_format(surface) & format:
				node.mesh.surface_set_material(surface, material)
				node.add_to_group("cloudbake", true)
				node.set_meta("switch_pixels", switch_pixels)    # of a level of detail; cloudbake_levels.gd reads it
	for child in node.get_children():
		_set_material(child, material, format, switch_pixels)
