// Filmic curve after Hejl and Burgess-Dawson: tone mapping and sRGB encoding in one rational function, no powers.
// Twin of app::toneMap in app/frame/ToneMap.h.
vec3 toneMap(vec3 radiance) {
    vec3 x = max(radiance * (1.4 * frame.sunIrradiance.w) - 0.004, 0.0);
    return (x * (6.2 * x + 0.5)) / (x * (6.2 * x + 1.7) + 0.06);
}
