# Draws one of the levels of detail of a cloud, by the pixels that it covers: attach this script to a Node3D, and give it the imported
# asset and its levels (`cloudbake bake --lods`), the finest one first. Godot's visibility ranges choose the level and dissolve it into the
# next one. They measure the distance to the cloud's centre, so they are set for the nearest point of its box. A camera that zooms, or a
# window of another height, needs refresh().
extends Node3D

@export var levels: Array[PackedScene]
@export_range(0.0, 0.9) var switch_band = 0.1    # the share of a switch's distance over which two levels are mixed
@export var fov = 70.0    # vertical field of view of the camera, degrees

var _shown = []    # of each level: its meshes
var _limits = []    # of each level: the most pixels that the cloud may cover, as its asset says


func _ready():
	for scene in levels:
		var level = scene.instantiate()
		add_child(level)
		var meshes = _meshes_of(level, [])
		_limits.append(float(meshes[0].get_meta("switch_pixels")))
		_shown.append(meshes)
	get_viewport().size_changed.connect(refresh)
	refresh()


# Sets the ranges anew.
func refresh():
	var begin = 0.0
	for i in _shown.size():
		var next = i + 1
		while next < _shown.size() and _limits[next] <= 0:    # a level that may never be drawn
			next += 1
		var end = _distance(_limits[next]) if next < _shown.size() else 0.0
		for mesh in _shown[i]:
			mesh.visible = i == 0 or _limits[i] > 0
			mesh.visibility_range_begin = begin
			mesh.visibility_range_end = end    # 0: without end
			mesh.visibility_range_begin_margin = switch_band * begin
			mesh.visibility_range_end_margin = switch_band * end
			mesh.visibility_range_fade_mode = GeometryInstance3D.VISIBILITY_RANGE_FADE_SELF
		if i == 0 or _limits[i] > 0:
			begin = end


# From the centre of the cloud, where it covers so many pixels (preview/mesh_clouds/levels.h).
func _distance(pixels):
	var box = AABB()
	for mesh in _shown[0]:
		var own = mesh.global_transform * mesh.get_aabb()
		box = box.merge(own) if box.has_surface() else own
	var height = get_viewport().get_visible_rect().size.y
	var nearest = box.get_longest_axis_size() * height / (2 * pixels * tan(deg_to_rad(fov) / 2))
	return nearest + box.size.length() / 2


func _meshes_of(node, found):
	if node.is_in_group("cloudbake"):
		found.append(node)
	for child in node.get_children():
		_meshes_of(child, found)
	return found
