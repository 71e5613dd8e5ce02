# Draws the pictures of res://jobs.json, one after the other, in the project of the kit: godot3 --path PROJECT -s res://pictures.gd
extends SceneTree

var viewport = Viewport.new()
var settings


func _init():
	var file = File.new()
	file.open("res://jobs.json", File.READ)
	settings = JSON.parse(file.get_as_text()).result
	viewport.size = vector2(settings.size)
	viewport.own_world = true
	viewport.render_target_update_mode = Viewport.UPDATE_ALWAYS
	viewport.render_target_v_flip = true
	root.add_child(viewport)
	for job in settings.jobs:
		var scene = scene_of(job)
		viewport.add_child(scene)
		for frame in 3:
			yield(self, "idle_frame")
		viewport.get_texture().get_data().save_png("res://%s.png" % job.name)
		viewport.remove_child(scene)
		scene.free()
	quit()


func vector2(list):
	return Vector2(list[0], list[1])


func vector3(list):
	return Vector3(list[0], list[1], list[2])


func scene_of(job):
	var scale = job.get("scale", 1.0)
	var scene = Spatial.new()
	var cloud = load("res://%s.glb" % job.asset).instance()
	cloud.scale = Vector3.ONE * scale
	scene.add_child(cloud)
	for node in clouds_of(cloud, []):
		if "shader" in job:
			node.material_override = changed_material(node, job)
		if job.get("instanced", false):
			scene.add_child(instanced(node))
			node.hide()
	var camera = Camera.new()
	scene.add_child(camera)
	camera.look_at_from_position(scale * vector3(settings.eye), scale * vector3(settings.target), Vector3.UP)
	camera.fov = settings.fov
	camera.near = scale * 0.1
	camera.far = scale * 100.0
	var sun = DirectionalLight.new()
	sun.look_at_from_position(vector3(job.sun), Vector3.ZERO, Vector3.UP)
	sun.set_script(load("res://cloudbake/cloudbake_sun.gd"))
	scene.add_child(sun)
	return scene


func clouds_of(node, found):
	if node.is_in_group("cloudbake"):
		found.append(node)
	for child in node.get_children():
		clouds_of(child, found)
	return found


# The material that the import made, with another shader and other values.
func changed_material(node, job):
	var material = node.mesh.surface_get_material(0).duplicate()
	material.shader = load("res://%s.shader" % job.shader)
	for name in job.get("parameters", {}):
		var value = job.parameters[name]
		material.set_shader_param(name, vector3(value) if value is Array else value)
	for name in job.get("factors", {}):
		material.set_shader_param(name, material.get_shader_param(name) * job.factors[name])
	return material


# The same as an instance of a MultiMesh: a turn is in the instance, and the rest in the node.
func instanced(node):
	var turn = Transform(Basis(Vector3(1, 2, 3).normalized(), 1.0), Vector3(0.5, 1, -2))
	var many = MultiMesh.new()
	many.transform_format = MultiMesh.TRANSFORM_3D
	many.mesh = node.mesh
	many.instance_count = 1
	many.set_instance_transform(0, turn)
	var shown = MultiMeshInstance.new()
	shown.multimesh = many
	shown.transform = node.transform * turn.affine_inverse()
	shown.material_override = node.material_override
	shown.add_to_group("cloudbake")
	return shown
