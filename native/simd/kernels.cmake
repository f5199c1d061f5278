# One object an instruction set, of which only its table of kernels can be seen: whatever inline functions came along are bound
# inside, so that the rest of the program never runs code that an older processor lacks. Sets KERNEL_OBJECTS.
set(KERNEL_SOURCES)
foreach(source gram products slices table)
  list(APPEND KERNEL_SOURCES ${CMAKE_CURRENT_LIST_DIR}/${source}.cpp)
endforeach()

function(add_kernels name)
  set(library mesoshell_kernels_${name})
  add_library(${library} OBJECT ${KERNEL_SOURCES})
  target_compile_features(${library} PRIVATE cxx_std_20)
  target_compile_options(${library} PRIVATE -Wall -Wextra -Wno-psabi -fno-gnu-unique ${ARGN})
  target_compile_definitions(${library} PRIVATE
    MESOSHELL_INSTRUCTION_SET="${name}" MESOSHELL_KERNELS_NAME=mesoshell_kernels_${name})
  target_link_libraries(${library} PRIVATE Eigen3::Eigen)
  set_target_properties(${library} PROPERTIES
    POSITION_INDEPENDENT_CODE ON CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  set(bound ${CMAKE_CURRENT_BINARY_DIR}/kernels_${name}.o)
  add_custom_command(
    OUTPUT ${bound}
    COMMAND ${CMAKE_LINKER} -r --force-group-allocation -o ${bound} $<TARGET_OBJECTS:${library}>
    COMMAND ${CMAKE_OBJCOPY} --keep-global-symbol=mesoshell_kernels_${name} ${bound}
    DEPENDS ${library} $<TARGET_OBJECTS:${library}>
    COMMAND_EXPAND_LISTS VERBATIM)
  set(KERNEL_OBJECTS ${KERNEL_OBJECTS} ${bound} PARENT_SCOPE)
endfunction()

add_kernels(baseline)
# instruction_set.cpp asks the processor for just these.
add_kernels(avx2 -mavx2 -mfma)
# GCC 12 takes the undefined vectors of its own AVX-512 header for a mistake.
add_kernels(avx512 -mavx2 -mfma -mavx512f -mavx512vl -mavx512dq -mavx512bw -Wno-maybe-uninitialized)
