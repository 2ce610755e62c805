"""Cavities and a cooling tower [montanaro2007]."""
from report import Row, change, fact, joined


def kelvin(lab, database):
    """{(profile, reflections): [kelvin along the profile]}"""
    out = {}
    for row in lab.table(lab.irsig("profile", database, "--csv")):
        out.setdefault((row["profile"], int(row["reflections"])), []).append(float(row["source_radiance_temperature_k"]))
    return out


def findings(lab):
    box = {key: values[0] for key, values in kelvin(lab, lab.run("cavity", lab.example("cavity"))).items()}
    special = [box["specular, depth 1", n] for n in (0, 1, 2, 3, 8)]
    deep = [box["specular, depth 3", n] for n in (0, 1, 2, 3, 8)]
    diffuse = [box["diffuse, depth 1", n] for n in (0, 1, 2, 3, 8)]
    figure = [box["specular, depth 1", 1], box["specular, depth 2", 2], deep[3]]
    lack = [306 - box[f"{walls}, depth 1", 40] for walls in ("specular", "diffuse")]
    tower = kelvin(lab, lab.run("cooling_tower", change(lab.example("cooling_tower"), (r"^target_paths = 4e6", "target_paths = 1e5"),
                                                        (r"^thumbnail_px = 256", "thumbnail_px = 0"))))
    place = {name: tower[name, 40][0] for name in ("deep inside", "deck", "hub", "ground")}
    line = tower["across the throat", 40]
    middle = len(line) // 2
    wall = lab.table(lab.irsig("material", "show", f"{lab.folder}/cavity.toml:specular wall", "--lambda-um", 10, "--theta-i-deg",
                               "0,45,89", "--csv"))
    dhr = [float(row["dhr"]) for row in wall]
    return [
        Row("section 3.1", "reflectance (DHR) of walls of rho_d 0.02, rho_s 0.13, alpha 0.015", "0.11",
            f"{joined(dhr, '{:.3f}')} at 0, 45, 89 deg", fact(abs(dhr[1] - 0.11) < 0.005), "holds at 45 deg, where the sensor looks"),
        Row("Figure 4", "source radiance temperature after N = 1, 2, 3 reflections, box made deeper by one length each time [K]",
            "two points below 306; 306", joined(figure, "{:.3f}"),
            "yes" if figure[2] > 305.95 > figure[1] else "in order" if figure == sorted(figure) else "no",
            "306 K is never reached: walls reflect 2 % diffusely, and the sky of 240 K keeps a weight of 0.4 %; the "
            "paper gives whole kelvins"),
        Row("Figure 4", "it rises with the number of reflections: specular, depth 1, N = 0, 1, 2, 3, 8 [K]", "yes",
            joined(special, "{:.3f}"), fact(special == sorted(special) and special[0] < special[4])),
        Row("section 3.2", "diffuse walls come near more slowly: depth 1, N = 0, 1, 2, 3, 8 [K]", "yes", joined(diffuse, "{:.3f}"),
            fact(all(306 - d > 306 - s for d, s in zip(diffuse[1:], special[1:]))), "they show the sky to every wall"),
        Row("section 3.2", "a mirroring wall shows other walls, not the sky: what 306 K lacks after 40 reflections, specular, "
            "diffuse [K]", "none; more", joined(lack, "{:.3f}"),
            "yes" if lack[0] < 0.05 else "in order" if lack[0] < lack[1] else "no", "the 2 % of diffuse reflectance"),
        Row("Figure 6", "tower: brightest deep within, then the deck; the ground is darkest [K]", "yes",
            joined([place[n] for n in ("deep inside", "deck", "ground")], "{:.2f}"),
            fact(place["deep inside"] > place["deck"] > place["ground"])),
        Row("Figure 8", "across the throat: a depression at the hub, cool deck at both ends: deck, inside, hub, inside, deck [K]", "yes",
            joined([line[2], max(line[:middle]), line[middle], max(line[middle:]), line[-3]], "{:.1f}"),
            fact(max(line[:middle]) > line[middle] + 1 and max(line[middle:]) > line[-3] + 1 and max(line[:middle]) > line[2] + 1)),
        Row("Figure 8", "contrast of the profile, simulated over measured", "2", "-", "not compared",
            "no dimensions, sky or air in the paper, and its image of the measured tower gives no table"),
    ]
