# Every flag of ours lives on this one target: linking it is how a folder opts in.
add_library(sightline_flags INTERFACE)
target_compile_options(sightline_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor)
if(SIGHTLINE_WARNINGS_AS_ERRORS)
  target_compile_options(sightline_flags INTERFACE -Werror)
endif()
if(SIGHTLINE_SANITIZER)
  target_compile_options(sightline_flags INTERFACE -fsanitize=${SIGHTLINE_SANITIZER} -fno-omit-frame-pointer
                                                   -fno-sanitize-recover=all)
  target_compile_definitions(sightline_flags INTERFACE _GLIBCXX_ASSERTIONS)
  target_link_options(sightline_flags INTERFACE -fsanitize=${SIGHTLINE_SANITIZER})
endif()

# sightline_library(NAME SOURCES... ) builds sightline_NAME, known to its users as sightline::NAME.
function(sightline_library name)
  add_library(sightline_${name} STATIC ${ARGN})
  add_library(sightline::${name} ALIAS sightline_${name})
  target_include_directories(sightline_${name} PUBLIC ${PROJECT_SOURCE_DIR})
  target_link_libraries(sightline_${name} PRIVATE sightline_flags)
endfunction()

# sightline_embeddable(NAME): sightline_NAME may become part of a shared library, and its own names do not leave it.
function(sightline_embeddable name)
  set_target_properties(sightline_${name} PROPERTIES
    POSITION_INDEPENDENT_CODE ON CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
endfunction()
