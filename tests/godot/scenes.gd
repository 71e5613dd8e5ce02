# Draws the scenes of res://jobs.json in linear colours, one after the other: godot3 --path PROJECT -s res://scenes.gd
# NAME.raw has width, height and format of Godot's Image, 32 bits each, and its pixels, bottom row first.
extends SceneTree


func _init():
	var file = File.new()
	file.open("res://jobs.json", File.READ)
	for job in JSON.parse(file.get_as_text()).result:
		var viewport = viewport_for(job)
		root.add_child(viewport)
		var camera = Camera.new()
		viewport.add_child(camera)
		place_camera(camera, job)
		camera.environment = environment_of(job)
		var clouds = []
		for place in job.clouds:
			clouds.append(cloud_at(place, job))
			viewport.add_child(clouds[-1])
		for solid in job.get("solids", []):
			viewport.add_child(box(solid))
		for light in job.get("lights", []):
			viewport.add_child(light_of(light))
		var nodes = {}
		for script in job.get("scripts", {}):
			nodes[script] = scripted(script, job.scripts[script])
			viewport.add_child(nodes[script])
		var views = job.get("views", [{}])
		for i in views.size():
			for key in views[i]:
				job[key] = views[i][key]
			place_camera(camera, job)
			viewport.size = vector(job.size)
			for cloud in clouds:
				if "seconds" in job:    # of sequences
					cloud.stop()
					cloud.seek(job.seconds)
			if "limit" in job:
				nodes["cloudbake_levels"]._limits[1] = job.limit
			if job.get("leaves", false):
				viewport.remove_child(nodes["cloudbake_painted"])
			for frame in 3:
				yield(self, "idle_frame")
			save(viewport, job.name if views.size() == 1 else "%s_%d" % [job.name, i])
		for name in job.get("passes", []):
			save(nodes["cloudbake_painted"].get_node(name), "%s_%s" % [job.name, name])
		root.remove_child(viewport)
		viewport.free()
	quit()


func vector(list):
	return Vector2(list[0], list[1]) if list.size() == 2 else Vector3(list[0], list[1], list[2])


func value_of(value):
	return vector(value) if value is Array else value


func viewport_for(job):
	var viewport = Viewport.new()
	viewport.size = vector(job.size)
	viewport.own_world = true
	viewport.usage = Viewport.USAGE_3D
	viewport.hdr = true
	viewport.keep_3d_linear = not job.get("tone", false)
	viewport.render_target_update_mode = Viewport.UPDATE_ALWAYS
	return viewport


func place_camera(camera, job):
	camera.look_at_from_position(vector(job.eye), vector(job.target), Vector3.UP)
	camera.fov = job.fov
	camera.near = job.get("near", 0.05)
	camera.far = 200.0
	if "sample" in job:    # the place of the ray in every pixel, from its upper left corner
		var height = 2 * camera.near * tan(deg2rad(job.fov) / 2)
		var shift = (vector(job.sample) - Vector2(0.5, 0.5)) * height / job.size[1]
		camera.set_frustum(height, Vector2(shift.x, -shift.y), camera.near, camera.far)
	camera.current = true


func environment_of(job):
	var environment = Environment.new()
	environment.background_mode = Environment.BG_COLOR
	environment.background_color = Color(job.background[0], job.background[1], job.background[2])
	if job.get("tone", false):
		environment.tonemap_mode = Environment.TONE_MAPPER_ACES
		environment.tonemap_exposure = job.tone.exposure
		environment.tonemap_white = job.tone.white
	return environment


func cloud_at(place, job):
	var cloud = load("res://%s.glb" % place.asset).instance()
	cloud.translation = vector(place.get("at", [0, 0, 0]))
	cloud.scale = Vector3.ONE * place.get("scale", 1.0)
	cloud.rotation_degrees.y = place.get("turn", 0.0)
	for node in clouds_of(cloud, []):
		var material = node.mesh.surface_get_material(0).duplicate()
		if "shader" in job:
			material.shader = load("res://%s.shader" % job.shader)
		for name in job.get("parameters", {}):
			material.set_shader_param(name, value_of(job.parameters[name]))
		node.material_override = material
	return cloud


func clouds_of(node, found):
	if node.is_in_group("cloudbake"):
		found.append(node)
	for child in node.get_children():
		clouds_of(child, found)
	return found


func box(solid):
	var shown = MeshInstance.new()
	shown.mesh = CubeMesh.new()
	shown.mesh.size = vector(solid.size)
	shown.translation = vector(solid.at)
	var material = SpatialMaterial.new()
	material.flags_unshaded = true
	material.albedo_color = Color(solid.color[0], solid.color[1], solid.color[2])
	shown.material_override = material
	return shown


func light_of(light):
	var shown = SpotLight.new() if "angle" in light else OmniLight.new()
	shown.translation = vector(light.at)
	if "angle" in light:
		shown.look_at_from_position(vector(light.at), vector(light.towards), Vector3.UP)
		shown.spot_angle = light.angle
	shown.set("spot_range" if "angle" in light else "omni_range", light["range"])
	shown.light_color = Color(light.color[0], light.color[1], light.color[2])
	shown.light_energy = light.energy
	shown.add_to_group("cloudbake_lamps")
	return shown


func scripted(name, settings):
	var script = load("res://cloudbake/%s.gd" % name)
	var node = ClassDB.instance(script.get_instance_base_type())
	node.name = name
	node.set_script(script)
	for key in settings:
		if not key in ["picture", "levels"]:
			node.set(key, value_of(settings[key]))
	if "picture" in settings:
		node.picture = texture_of(settings.picture)
	if "levels" in settings:
		node.levels = scenes_of(settings.levels)
	return node


func texture_of(path):
	var image = Image.new()
	image.load(path)
	var texture = ImageTexture.new()
	texture.create_from_image(image, Texture.FLAG_FILTER)
	return texture


func scenes_of(paths):
	var scenes = []
	for path in paths:
		scenes.append(load(path))
	return scenes


func save(viewport, name):
	var image = viewport.get_texture().get_data()
	var file = File.new()
	file.open("res://%s.raw" % name, File.WRITE)
	for number in [image.get_width(), image.get_height(), image.get_format()]:
		file.store_32(number)
	file.store_buffer(image.get_data())
	file.close()
