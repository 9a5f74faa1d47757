// For the leak sanitizer: libraries stay loaded to the end, so that what they still hold then, as Mesa's drivers
// do for each of their threads, is not taken for lost.
extern "C" int dlclose(void*) {
    return 0;
}
