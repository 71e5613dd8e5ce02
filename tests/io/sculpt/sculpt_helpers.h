// What the tests of sculpts share.
#pragma once

#include <string>

namespace cloudbake {

/// The first bytes of a PNG are enough where nobody decodes it.
inline const std::string kPng = std::string("\x89PNG\r\n\x1A\n") + "rest";

// --- Collada ---

// <source> of `count` elements with the given parameters (XYZ, ST, RGB).
inline std::string daeSource(const std::string& id, const std::string& values, int count, const std::string& parameters) {
  std::string names;
  for (const char c : parameters) names += std::string("<param name=\"") + c + "\" type=\"float\"/>";
  const std::string stride = std::to_string(parameters.size());
  return "<source id=\"" + id + "\"><float_array id=\"" + id + "a\" count=\"" + std::to_string(count * int(parameters.size())) + "\">" +
         values + "</float_array><technique_common><accessor source=\"#" + id + "a\" count=\"" + std::to_string(count) + "\" stride=\"" +
         stride + "\">" + names + "</accessor></technique_common></source>";
}

inline std::string daeNode(const std::string& name, const std::string& content) {
  return "<node id=\"" + name + "\" name=\"" + name + "\">" + content + "</node>";
}

inline const std::string kDaeInstance =
    "<instance_geometry url=\"#g\"><bind_material><technique_common><instance_material symbol=\"s\" target=\"#m\"/></technique_common>"
    "</bind_material></instance_geometry>";

// A tetrahedron with two UV sets, colours and a material, under an empty that is moved, beside a camera and a light.
inline std::string texturedDae() {
  const std::string positions = daeSource("p", "0 0 0 1 0 0 0 1 0 0 0 1", 4, "XYZ"), uvs = daeSource("t", "0 0 1 0 0 1 1 1", 4, "ST"),
                    more = daeSource("u", "0 0 0.5 0 0 0.5 0.5 0.5", 4, "ST"), colors = daeSource("c", "1 0 0 0 1 0 0 0 1 1 1 1", 4, "RGB");
  const std::string mesh =
      positions + uvs + more + colors +
      "<vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices><triangles count=\"4\" material=\"s\">"
      "<input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><input semantic=\"TEXCOORD\" source=\"#t\" offset=\"0\" set=\"0\"/>"
      "<input semantic=\"TEXCOORD\" source=\"#u\" offset=\"0\" set=\"1\"/><input semantic=\"COLOR\" source=\"#c\" offset=\"0\"/>"
      "<p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles>";
  const std::string effect =
      "<effect id=\"e\"><profile_COMMON><newparam sid=\"f\"><surface type=\"2D\"><init_from>i</init_from></surface></newparam>"
      "<newparam sid=\"x\"><sampler2D><source>f</source></sampler2D></newparam><technique sid=\"c\"><phong>"
      "<emission><color>0 0 0.5 1</color></emission><diffuse><texture texture=\"x\" texcoord=\"a\"/></diffuse>"
      "<shininess><float>30</float></shininess></phong></technique></profile_COMMON></effect>";
  const std::string scene = daeNode("Empty", "<translate>0 0 5</translate>" + daeNode("Body", "<scale>2 2 2</scale>" + kDaeInstance) +
                                                 daeNode("Twin", "<translate>9 0 0</translate>" + kDaeInstance)) +
                            daeNode("Eye", "<instance_camera url=\"#cam\"/>") + daeNode("Lamp", "<instance_light url=\"#lit\"/>");
  return "<?xml version=\"1.0\"?><COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" version=\"1.4.1\"><asset>"
         "<unit name=\"metre\" meter=\"1\"/><up_axis>Y_UP</up_axis></asset>"
         "<library_cameras><camera id=\"cam\"><optics><technique_common><perspective><xfov>45</xfov><znear>1</znear><zfar>9</zfar>"
         "</perspective></technique_common></optics></camera></library_cameras>"
         "<library_lights><light id=\"lit\"><technique_common><point><color>1 1 "
         "1</color></point></technique_common></light></library_lights>"
         "<library_images><image id=\"i\" name=\"i\"><init_from>skin.png</init_from></image></library_images>"
         "<library_effects>" +
         effect +
         "</library_effects><library_materials><material id=\"m\" name=\"clay\"><instance_effect url=\"#e\"/>"
         "</material></library_materials><library_geometries><geometry id=\"g\" name=\"g\"><mesh>" +
         mesh +
         "</mesh></geometry>"
         "</library_geometries><library_visual_scenes><visual_scene id=\"scene\" name=\"scene\">" +
         scene + "</visual_scene></library_visual_scenes><scene><instance_visual_scene url=\"#scene\"/></scene></COLLADA>";
}

}  // namespace cloudbake
