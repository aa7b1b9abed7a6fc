find_package(Threads REQUIRED)
find_package(glm REQUIRED)
find_package(xxHash REQUIRED)          # cmake/FindxxHash.cmake
find_package(TinyGLTF REQUIRED)
find_package(assimp REQUIRED)
find_package(OSMesa REQUIRED)          # cmake/FindOSMesa.cmake
find_package(OpenGL REQUIRED COMPONENTS EGL)
find_package(glfw3 REQUIRED)
find_package(embree 3 REQUIRED CONFIG)  # brings TBB
find_package(Stb REQUIRED)             # cmake/FindStb.cmake
find_package(ImGui REQUIRED)           # cmake/FindImGui.cmake
find_package(FlatBuffers REQUIRED CONFIG)
find_package(ZeroMQ REQUIRED)          # cmake/FindZeroMQ.cmake (libzmq through cppzmq)
find_package(Sodium REQUIRED)          # cmake/FindSodium.cmake (digests of uploaded scenes)
find_package(roaring REQUIRED CONFIG)
find_package(Ceres REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(CLI11 REQUIRED)
find_package(tomlplusplus REQUIRED)
find_package(spdlog REQUIRED)
if(SIGHTLINE_BUILD_TESTS)
  find_package(GTest REQUIRED)
endif()
if(SIGHTLINE_BUILD_BENCHMARKS)
  find_package(benchmark REQUIRED)
endif()
