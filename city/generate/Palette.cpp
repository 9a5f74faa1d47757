#include "city/generate/Palette.h"

#include "city/generate/Random.h"

namespace city {

const FacadeStyle& Palette::oldFacade(Random& random) const {
    return facades[random.index(firstGlassFacade)];
}

const FacadeStyle& Palette::glassFacade(Random& random) const {
    return facades[firstGlassFacade + random.index(facades.size() - firstGlassFacade)];
}

Palette makePalette() {
    Palette p;
    const auto add = [&](Pattern pattern, glm::vec3 tint, float size = 1, bool twoSided = false) {
        Material m;
        m.pattern = pattern;
        m.tint = tint;
        m.patternSize = size;
        m.twoSided = twoSided;
        p.materials.push_back(m);
        return static_cast<std::uint32_t>(p.materials.size() - 1);
    };

    p.streets.asphalt = add(Pattern::asphalt, {0.105f, 0.105f, 0.11f}, 4);
    p.streets.pavement = add(Pattern::pavement, {0.3f, 0.29f, 0.27f}, 2);
    p.streets.kerb = add(Pattern::plain, {0.42f, 0.41f, 0.39f}, 1);
    p.streets.marking = add(Pattern::marking, {0.72f, 0.72f, 0.7f}, 1);
    p.streets.tramBed = add(Pattern::grass, {0.14f, 0.18f, 0.07f}, 2.5f);
    p.streets.rail = add(Pattern::rail, {0.4f, 0.39f, 0.38f}, 1);

    p.grass = add(Pattern::grass, {0.13f, 0.18f, 0.06f}, 2.5f);
    p.meadow = add(Pattern::grass, {0.17f, 0.2f, 0.08f}, 16);
    p.hills = add(Pattern::plain, {0.13f, 0.17f, 0.13f}, 50);
    p.soil = add(Pattern::soil, {0.14f, 0.1f, 0.07f}, 2);
    p.gravel = add(Pattern::soil, {0.42f, 0.37f, 0.28f}, 2);
    p.water = add(Pattern::water, {0.07f, 0.13f, 0.15f}, 4);
    p.cobbles = add(Pattern::cobbles, {0.29f, 0.275f, 0.26f}, 2);
    p.slabs = add(Pattern::pavement, {0.36f, 0.345f, 0.315f}, 3);
    p.bark = add(Pattern::bark, {0.16f, 0.125f, 0.095f}, 1);
    p.foliageBright = add(Pattern::foliage, {0.105f, 0.165f, 0.04f}, 1, true);
    p.foliageDark = add(Pattern::foliage, {0.07f, 0.125f, 0.035f}, 1, true);
    p.foliageShade = add(Pattern::foliage, {0.04f, 0.075f, 0.02f}, 1);
    p.foliageWarm = add(Pattern::foliage, {0.15f, 0.17f, 0.045f}, 1, true);
    p.metalDark = add(Pattern::metal, {0.05f, 0.055f, 0.06f}, 1);
    p.metalLight = add(Pattern::metal, {0.42f, 0.43f, 0.44f}, 1);
    p.wood = add(Pattern::bark, {0.32f, 0.2f, 0.11f}, 1);
    p.granite = add(Pattern::wall, {0.4f, 0.385f, 0.37f}, 2);
    p.bronze = add(Pattern::metal, {0.11f, 0.14f, 0.11f}, 1);
    p.copper = add(Pattern::metal, {0.25f, 0.42f, 0.35f}, 2);
    p.lampGlass = add(Pattern::plain, {0.75f, 0.72f, 0.65f}, 1);
    p.materials[p.lampGlass].emission = {9, 7.2f, 4.6f};  // shown when the lamps are lit
    p.roofFlat = add(Pattern::roofFlat, {0.3f, 0.295f, 0.285f}, 4);
    p.zinc = add(Pattern::metal, {0.25f, 0.27f, 0.3f}, 2);
    p.shelterGlass = add(Pattern::plain, {0.32f, 0.4f, 0.42f}, 1, true);

    for (const glm::vec3& tint : {glm::vec3(0.36f, 0.13f, 0.075f), glm::vec3(0.28f, 0.115f, 0.08f),
                                  glm::vec3(0.4f, 0.19f, 0.11f), glm::vec3(0.13f, 0.13f, 0.14f)}) {
        p.roofTiles.push_back(add(Pattern::roofTiles, tint, 2));
    }

    const auto style = [&](Pattern pattern, glm::vec3 tint, glm::vec3 trim, bool glass = false) {
        FacadeStyle s;
        s.facade = add(pattern, tint, 3);
        s.blank = add(pattern == Pattern::facadeGlass ? Pattern::plain : Pattern::wall, 0.92f * tint, 3);
        s.trim = add(Pattern::plain, trim, 1);
        s.glass = glass;
        p.facades.push_back(s);
    };
    const glm::vec3 white(0.68f, 0.66f, 0.62f), sand(0.56f, 0.5f, 0.4f), grey(0.42f, 0.41f, 0.4f);
    style(Pattern::facadePlaster, {0.7f, 0.64f, 0.5f}, white);    // cream
    style(Pattern::facadePlaster, {0.68f, 0.52f, 0.27f}, white);  // ochre
    style(Pattern::facadePlaster, {0.7f, 0.68f, 0.64f}, grey);    // off-white
    style(Pattern::facadePlaster, {0.64f, 0.44f, 0.36f}, white);  // old rose
    style(Pattern::facadePlaster, {0.52f, 0.55f, 0.56f}, white);  // light grey
    style(Pattern::facadePlaster, {0.5f, 0.57f, 0.45f}, white);   // pale green
    style(Pattern::facadePlaster, {0.48f, 0.56f, 0.63f}, white);  // pale blue
    style(Pattern::facadePlaster, {0.6f, 0.33f, 0.22f}, sand);    // terracotta
    style(Pattern::facadeBrick, {0.5f, 0.4f, 0.34f}, sand);
    style(Pattern::facadeBrick, {0.42f, 0.3f, 0.26f}, white);
    style(Pattern::facadeBrick, {0.62f, 0.54f, 0.42f}, grey);
    style(Pattern::facadeStone, {0.6f, 0.55f, 0.45f}, sand);   // sandstone
    style(Pattern::facadeStone, {0.58f, 0.57f, 0.54f}, grey);  // limestone
    style(Pattern::facadeStone, {0.5f, 0.46f, 0.42f}, sand);
    p.firstGlassFacade = p.facades.size();
    style(Pattern::facadeGlass, {0.62f, 0.68f, 0.72f}, grey, true);
    style(Pattern::facadeGlass, {0.6f, 0.66f, 0.62f}, {0.2f, 0.2f, 0.21f}, true);

    for (const glm::vec3& tint :
         {glm::vec3(0.75f, 0.72f, 0.66f), glm::vec3(0.5f, 0.32f, 0.2f), glm::vec3(0.3f, 0.42f, 0.36f),
          glm::vec3(0.36f, 0.38f, 0.42f), glm::vec3(0.6f, 0.28f, 0.22f), glm::vec3(0.32f, 0.4f, 0.55f)}) {
        p.shops.push_back(add(Pattern::shopFront, tint, 4));
    }
    for (const glm::vec3& tint :
         {glm::vec3(0.5f, 0.05f, 0.045f), glm::vec3(0.05f, 0.2f, 0.09f), glm::vec3(0.06f, 0.12f, 0.32f),
          glm::vec3(0.65f, 0.58f, 0.42f), glm::vec3(0.6f, 0.3f, 0.05f), glm::vec3(0.28f, 0.05f, 0.1f)}) {
        p.awnings.push_back(add(Pattern::plain, tint, 1, true));
    }
    for (const glm::vec3& tint :
         {glm::vec3(0.45f, 0.05f, 0.05f), glm::vec3(0.05f, 0.11f, 0.36f), glm::vec3(0.05f, 0.27f, 0.12f),
          glm::vec3(0.62f, 0.46f, 0.06f), glm::vec3(0.05f, 0.05f, 0.055f), glm::vec3(0.6f, 0.58f, 0.55f),
          glm::vec3(0.32f, 0.08f, 0.28f), glm::vec3(0.06f, 0.33f, 0.36f)}) {
        p.signs.push_back(add(Pattern::plain, tint, 1));
    }
    return p;
}

void addStoneShops(Palette& palette) {
    for (const glm::vec3& tint : {glm::vec3(0.66f, 0.66f, 0.65f), glm::vec3(0.58f, 0.6f, 0.63f)}) {
        Material m;
        m.pattern = Pattern::stoneFront;
        m.tint = tint;
        m.patternSize = 4;
        palette.materials.push_back(m);
        palette.stoneShops.push_back(static_cast<std::uint32_t>(palette.materials.size() - 1));
    }
}

}  // namespace city
