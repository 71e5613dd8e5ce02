func _set_frame(values):
	_set_value("picture", picture)
	_set_value("origin", _vector(values.origin))
	_set_value("right_over_width", _vector(values.right) / values.width)
	_set_value("up_over_height", _vector(values.up) / values.height)
	_set_value("to_sun", _vector(values.to_sun))
	_set_value("top", values.top)
	_set_value("bottom", values.bottom)


func _vector(list):
	return Vector3(list[0], list[1], list[2])
