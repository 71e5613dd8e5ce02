# Places the camera so that the whole cloud is in view. Left and right arrows turn the sun.
extends Spatial


func _ready():
	var box
	for node in get_tree().get_nodes_in_group("cloudbake"):
		var own = node.global_transform.xform(node.get_aabb())
		box = box.merge(own) if box else own
	var size = box.size.length()
	$Camera.near = 0.01 * size
	$Camera.far = 10 * size
	var center = box.position + 0.5 * box.size
	$Camera.look_at_from_position(center + size * Vector3(0, -0.2, 1.2), center, Vector3.UP)


func _process(delta):
	$Sun.rotate_y(delta * (Input.get_action_strength("ui_right") - Input.get_action_strength("ui_left")))
