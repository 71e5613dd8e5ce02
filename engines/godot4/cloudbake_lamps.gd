# Lights mesh clouds by OmniLight3Ds and SpotLight3Ds: attach this script to a Node of the scene, and add the lights to the group
# "cloudbake_lamps". The clouds need the shader cloudbake_soft. Light falls off with the square of the distance, up to the light's range.
extends Node

@export var strength = 1.0    # at the distance 1 a lamp has its colour, times its energy, times this
@export var radius = 0.1    # of each lamp; nearer it gets no brighter

var _texture = ImageTexture.new()


func _process(_delta):
	var lights = get_tree().get_nodes_in_group("cloudbake_lamps")
	var image = Image.create(4, maxi(lights.size(), 1), false, Image.FORMAT_RGBAF)
	for i in lights.size():
		_write(image, i, lights[i])
	_texture.set_image(image)
	for node in get_tree().get_nodes_in_group("cloudbake"):
		var mesh = node.multimesh.mesh if node is MultiMeshInstance3D else node.mesh
		for surface in mesh.get_surface_count():
			_light(mesh.surface_get_material(surface), lights.size())
		_light(node.material_override, lights.size())


# A row as lampsAt in the shader reads it. Godot's spotlights shine along -z.
func _write(image, row, light):
	var at = light.global_transform.origin
	var axis = -light.global_transform.basis.z.normalized()
	var is_spot = light is SpotLight3D
	var cone = Vector2(1, cos(deg_to_rad(light.spot_angle))) if is_spot else Vector2(-2, -2)
	var energy = strength * light.light_energy * (1.0 if light.is_visible_in_tree() else 0.0)
	var color = light.light_color.srgb_to_linear()
	image.set_pixel(0, row, Color(at.x, at.y, at.z, light.spot_range if is_spot else light.omni_range))
	image.set_pixel(1, row, Color(energy * color.r, energy * color.g, energy * color.b, radius))
	image.set_pixel(2, row, Color(axis.x, axis.y, axis.z, cone.x))
	image.set_pixel(3, row, Color(cone.y, 0, 0, 0))


func _light(material, count):
	if material is ShaderMaterial:
		material.set_shader_parameter("lamps", _texture)
		material.set_shader_parameter("lamp_count", count)
