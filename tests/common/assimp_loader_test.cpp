#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "common/scene/load_scene.hpp"
#include "tests/common/glb_file.hpp"
#include "tests/common/test_scenes.hpp"

namespace sightline {
namespace {

Scene load_text(const std::string& name, const std::string& text) {
  const testing::TemporaryFolder folder;
  testing::write_text(folder / name, text);
  return load_scene(folder / name);
}

TEST(AssimpLoader, ReadsObjWithItsMaterials) {
  const testing::TemporaryFolder folder;
  testing::write_text(folder / "a.mtl", "newmtl red\nKd 1 0 0\nnewmtl pane\nKd 0 0 1\nd 0.25\n");
  testing::write_text(folder / "a.obj",
                      "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\no first\nusemtl red\nf 1 2 3 4\n"
                      "o second\nusemtl pane\nf 1 2 3\n");
  const Scene scene = load_scene(folder / "a.obj");
  ASSERT_EQ(scene.object_count(), 2u);
  EXPECT_EQ(scene.triangle_count(ObjectId{0}), 2u);  // the quad is cut in two
  EXPECT_EQ(scene.triangle_count(ObjectId{1}), 1u);
  const auto material = [&](std::size_t object) {
    return scene
        .materials[scene.primitives[scene.meshes[scene.objects[object].mesh].first_primitive].material];
  };
  EXPECT_EQ(material(0).base_color, glm::vec4(1, 0, 0, 1));
  EXPECT_EQ(material(0).alpha_mode, AlphaMode::opaque);
  EXPECT_EQ(material(1).alpha_mode, AlphaMode::blend);
  EXPECT_FLOAT_EQ(material(1).base_color.a, 0.25f);
  EXPECT_EQ(scene.digest, load_scene(folder / "a.obj", {.shading = false}).digest);
}

TEST(AssimpLoader, ReadsPlyAndStlWithoutMaterials) {
  const Scene ply =
      load_text("a.ply",
                "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
                "float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 "
                "0\n0 2 0\n3 0 1 2\n");
  EXPECT_EQ(ply.triangle_count(), 1u);
  EXPECT_NEAR(ply.bounds.max.y, 2.0f, 1e-4f);
  const Scene stl =
      load_text("a.STL",
                "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 3 0\n"
                "endloop\nendfacet\nendsolid a\n");
  EXPECT_EQ(stl.triangle_count(), 1u);
  EXPECT_NEAR(stl.bounds.max.y, 3.0f, 1e-4f);
}

TEST(AssimpLoader, KeepsColladasNodesAndTheirSharedMesh) {
  const Scene scene = load_text("a.dae", R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><up_axis>Y_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="9">0 0 0 1 0 0 0 1 0</float_array>
<technique_common><accessor source="#pa" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s">
<node id="a"><translate>5 0 0</translate><instance_geometry url="#g"/>
<node id="b"><translate>0 7 0</translate><instance_geometry url="#g"/></node></node>
</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)");
  ASSERT_EQ(scene.object_count(), 2u);
  EXPECT_EQ(scene.objects[0].mesh, scene.objects[1].mesh);
  EXPECT_EQ(glm::dvec3(scene.objects[0].scene_from_object[3]), glm::dvec3(5, 0, 0));
  EXPECT_EQ(glm::dvec3(scene.objects[1].scene_from_object[3]), glm::dvec3(5, 7, 0));
}

TEST(AssimpLoader, TakesAnOpacityMapForSeeThrough) {
  const testing::TemporaryFolder folder;
  testing::write_text(folder / "a.mtl", "newmtl leaf\nKd 0 1 0\nmap_d leaf.png\n");
  testing::write_text(folder / "a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl leaf\nf 1 2 3\n");
  const Scene scene = load_scene(folder / "a.obj");
  EXPECT_EQ(scene.materials[scene.primitives[0].material].alpha_mode, AlphaMode::blend);
}

TEST(AssimpLoader, ReadsAsciiFbx) {
  const Scene scene = load_text("a.fbx", R"(; FBX 7.3.0 project file
FBXHeaderExtension:  {
	FBXHeaderVersion: 1003
	FBXVersion: 7300
}
GlobalSettings:  {
	Version: 1000
	Properties70:  {
		P: "UnitScaleFactor", "double", "Number", "",1
	}
}
Definitions:  {
	Version: 100
}
Objects:  {
	Geometry: 100, "Geometry::g", "Mesh" {
		Vertices: *9 {
			a: 0,0,0,1,0,0,0,2,0
		}
		PolygonVertexIndex: *3 {
			a: 0,1,-3
		}
		GeometryVersion: 124
	}
	Model: 200, "Model::m", "Mesh" {
		Version: 232
		Properties70:  {
			P: "Lcl Translation", "Lcl Translation", "", "A",5,0,0
		}
	}
}
Connections:  {
	C: "OO",200,0
	C: "OO",100,200
}
)");
  ASSERT_EQ(scene.object_count(), 1u);
  EXPECT_EQ(scene.triangle_count(), 1u);
  EXPECT_NEAR(scene.bounds.extent().y, 2.0f, 1e-3f);
  EXPECT_NEAR(scene.bounds.min.x, 5.0f, 1e-3f);
}

TEST(AssimpLoader, RefusesPointsAloneAndNumbersThatAreNone) {
  EXPECT_THROW((void)load_text("a.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n"), InputError);
  EXPECT_THROW((void)load_text("a.obj", "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), InputError);
  EXPECT_THROW((void)load_text("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"), InputError);
}

}  // namespace
}  // namespace sightline
