# Draws one of the levels of detail of a cloud, by the pixels that it covers: attach this script to a Spatial, and give it the imported
# asset and its levels (`cloudbake bake --lods`), the finest one first. The clouds need the shader cloudbake_soft, or cloudbake_painted.gd
# in the scene: then levels dissolve into each other; with the plain shader they change at once.
extends Spatial

export(Array, PackedScene) var levels
export(float, 0.0, 0.9) var switch_band = 0.1    # the share of a switch's size over which two levels are mixed

var _shown = []    # of each level: its meshes
var _limits = []    # of each level: the most pixels that the cloud may cover, as its asset says
var _size = AABB()


func _ready():
	for scene in levels:
		var level = scene.instance()
		add_child(level)
		var meshes = _meshes_of(level, [])
		for mesh in meshes:
			mesh.material_override = mesh.mesh.surface_get_material(0).duplicate()    # each cloud has a mix of its own
		_limits.append(INF if _shown.empty() else float(meshes[0].get_meta("switch_pixels")))
		_shown.append(meshes)
	for mesh in _shown[0]:
		var box = global_transform.affine_inverse() * mesh.global_transform
		_size = box.xform(mesh.get_aabb()) if _size.has_no_area() else _size.merge(box.xform(mesh.get_aabb()))


func _process(_delta):
	var camera = get_viewport().get_camera()
	if camera == null:
		return
	var pixels = _pixels_across(camera)
	var fine = 0
	for i in _limits.size():
		if pixels <= _limits[i]:
			fine = i
	# Just below the size at which a level may be drawn, it is mixed with the one before it.
	var from = _limits[fine] * (1 - switch_band)
	var mixed = smoothstep(from, _limits[fine], pixels) if fine > 0 and pixels > from else 0.0
	for i in _shown.size():
		var range_shown = Vector2(0, 1) if i == fine else Vector2()
		if mixed > 0 and i == fine:
			range_shown = Vector2(mixed, 1)
		elif mixed > 0 and i == fine - 1:
			range_shown = Vector2(0, mixed)
		for mesh in _shown[i]:
			mesh.visible = range_shown.y > range_shown.x
			mesh.material_override.set_shader_param("shown", range_shown)


# The pixels that the longest side would cover where its box is nearest to the camera (preview/mesh_clouds/levels.h).
func _pixels_across(camera):
	var scale = global_transform.basis.get_scale()
	var longest = max(max(_size.size.x * scale.x, _size.size.y * scale.y), _size.size.z * scale.z)
	var eye = camera.global_transform.origin
	var box = global_transform.xform(_size)
	var nearest = Vector3(clamp(eye.x, box.position.x, box.end.x), clamp(eye.y, box.position.y, box.end.y),
			clamp(eye.z, box.position.z, box.end.z))
	var height = get_viewport().size.y
	return longest * height / max(2 * eye.distance_to(nearest) * tan(deg2rad(camera.fov) / 2), 1e-6)


func _meshes_of(node, found):
	if node.is_in_group("cloudbake"):
		found.append(node)
	for child in node.get_children():
		_meshes_of(child, found)
	return found
