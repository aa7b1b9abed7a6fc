# Debian ships ImGui without a CMake package of its own.
find_path(ImGui_INCLUDE_DIR NAMES imgui/imgui.h)
find_library(ImGui_LIBRARY NAMES imgui)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(ImGui REQUIRED_VARS ImGui_LIBRARY ImGui_INCLUDE_DIR)
if(ImGui_FOUND AND NOT TARGET ImGui::ImGui)
  add_library(ImGui::ImGui UNKNOWN IMPORTED)
  set_target_properties(ImGui::ImGui PROPERTIES IMPORTED_LOCATION ${ImGui_LIBRARY}
                        INTERFACE_INCLUDE_DIRECTORIES ${ImGui_INCLUDE_DIR})
endif()
