# What `cmake --install` puts where, in three components, and the Debian packages made of them:
#   library      libsightline.so.1                       libsightline1
#   development  header, CMake and pkg-config, manual    libsightline-dev
#   service      control_view, main_view, their manual   sightline
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

get_target_property(SIGHTLINE_C_VERSION sightline VERSION)
get_target_property(SIGHTLINE_C_SOVERSION sightline SOVERSION)

install(TARGETS sightline EXPORT sightlineTargets
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library NAMELINK_COMPONENT development
  PUBLIC_HEADER DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
install(TARGETS control_view main_view RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT service)

# find_package(sightline 1.0): versions are the C interface's.
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/sightline)
configure_package_config_file(cmake/package/sightlineConfig.cmake.in ${PROJECT_BINARY_DIR}/package/sightlineConfig.cmake
  INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/package/sightlineConfigVersion.cmake
  VERSION ${SIGHTLINE_C_VERSION} COMPATIBILITY SameMajorVersion)
install(EXPORT sightlineTargets NAMESPACE sightline:: DESTINATION ${package_folder} COMPONENT development)
install(FILES ${PROJECT_BINARY_DIR}/package/sightlineConfig.cmake ${PROJECT_BINARY_DIR}/package/sightlineConfigVersion.cmake
  DESTINATION ${package_folder} COMPONENT development)

# Relocatable: paths follow from where the file lies.
file(RELATIVE_PATH SIGHTLINE_PC_PREFIX /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
configure_file(cmake/package/sightline.pc.in ${PROJECT_BINARY_DIR}/package/sightline.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/package/sightline.pc
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)

install(FILES man/libsightline.3 DESTINATION ${CMAKE_INSTALL_MANDIR}/man3 COMPONENT development)
install(FILES man/control_view.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT service)
install(FILES examples/c/cull_scene.c examples/c/town.c examples/c/town.h examples/c/CMakeLists.txt
  DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/doc/libsightline-dev/examples/c COMPONENT development)

# Debian wants the licence of each package under the package's name.
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/doc/libsightline${SIGHTLINE_C_SOVERSION} RENAME copyright COMPONENT library)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/doc/libsightline-dev RENAME copyright COMPONENT development)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/doc/sightline RENAME copyright COMPONENT service)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME sightline)
set(CPACK_PACKAGE_VENDOR "The Sightline authors")
set(CPACK_PACKAGE_CONTACT "The Sightline authors <sightline@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL library development service)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY ">=")
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libsightline${SIGHTLINE_C_SOVERSION})
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libsightline-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libsightline${SIGHTLINE_C_SOVERSION} (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_SERVICE_PACKAGE_NAME sightline)
set(CPACK_DEBIAN_SERVICE_PACKAGE_SECTION graphics)
set(CPACK_COMPONENT_LIBRARY_DESCRIPTION "Visibility service for 3D renderers: the client library")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "Visibility service for 3D renderers: header and manual of the client library")
set(CPACK_COMPONENT_SERVICE_DESCRIPTION "Visibility service for 3D renderers: the daemon and the reference renderer")
include(CPack)
