// Writes the small maps that fuzzing begins with into the folder given.
#include "files.h"
#include "mesoshell/store.h"

int main(int count, char** arguments)
{
    if (count != 2) {
        return 2;
    }
    for (const auto precision : {mesoshell::Precision::half, mesoshell::Precision::single}) {
        for (const bool with_sdf : {false, true}) {
            const char* const type = precision == mesoshell::Precision::half ? "half" : "float";
            const std::string path = std::string(arguments[1]) + "/" + type + (with_sdf ? "_sdf.exr" : ".exr");
            mesoshell::save_map(mesoshell::small_map(precision, with_sdf), path);
        }
        const char* const name = precision == mesoshell::Precision::half ? "/half_all.exr" : "/float_all.exr";
        mesoshell::save_map(mesoshell::map_with_all_parts(precision), arguments[1] + std::string(name));
    }
    return 0;
}
