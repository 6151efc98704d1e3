// hypot by its first name in glibc. The linker would take that of glibc 2.35, the only symbol of the packages which is younger than 2.34:
// it differs in how errors are told, by errno, which nobody asks for.
extern "C" {
double seldinger_hypot(double x, double y);
__asm__(".symver seldinger_hypot,hypot@GLIBC_2.2.5");
__attribute__((visibility("hidden"))) double __wrap_hypot(double x, double y) { return seldinger_hypot(x, y); }
}
