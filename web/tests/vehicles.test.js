// Vehicles as they are drawn, as data: fifteen mechanisms as the server describes them, with motions that it simulated.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { captions } from "../src/vehicles/captions.js";
import { layout, rangeOf } from "../src/vehicles/layout.js";
import { REST, momentOf, passing } from "../src/vehicles/moments.js";
import { cornersOf, outlines, posed } from "../src/vehicles/posed.js";
import { heightOf, scene } from "../src/vehicles/scene.js";
import { endsOf } from "../src/vehicles/struts.js";
import { draw, planOf, travelOf } from "../src/vehicles/symbols.js";

const SIZES = [{ width: 566, height: 356 }, { width: 404, height: 400 }, { width: 1092, height: 560 }];
const FEW = 1e-6;

/** Each vehicle laid out in each size, with moments of its motion. */
const ALL = Object.entries(JSON.parse(readFileSync(new URL("vehicles.json", import.meta.url), "utf8")))
  .flatMap(([name, { model, outline, speed, mechanism, motion, shaded }]) => SIZES.map((size) => {
    const found = scene(mechanism, model, outline);
    const made = layout(found, size, rangeOf(found, motion ? [motion] : []));
    const times = motion ? motion.time.filter((_, i) => i % 3 === 0) : [];
    const moments = motion ? times.map((at) => momentOf(made, motion, at, { speed, shaded })) : [REST];
    return { name, mechanism, motion, shaded, speed, size, scene: found, made, moments };
  }));

/** @param {string} name */
const of = (name) => ALL.find((each) => each.name === name);

/** @param {(each: any, moment: any) => void} check of each vehicle at each moment */
const always = (check) => ALL.forEach((each) => each.moments.forEach((moment) => check(each, moment)));

const near = (a, b, within, said) => assert.ok(Math.abs(a - b) <= within, `${said}: ${a} is not ${b}`);

test("a vehicle is drawn as a car where the library declares it one, whatever it is called", () => {
  const { mechanism } = of("half car");
  assert.equal(scene(mechanism, "half-car").silhouette, false);
  assert.equal(scene(mechanism, "a van of somebody", "car").silhouette, true);
});

test("bodies, wheels and struts of each kind of vehicle are where they are", () => {
  const kinds = (name) => Object.fromEntries(of(name).scene.bodies.map((body) => [body.name, body.kind]));
  assert.equal(kinds("quarter car").unsprung, "wheel");
  assert.equal(kinds("seat").occupant, "occupant");
  assert.equal(kinds("rig").displacement, "table");
  const where = (name) => Object.fromEntries(of(name).scene.bodies.map(({ name: body, x, y }) => [body, [x, y]]));
  assert.deepEqual(where("half car").unsprung_front, [0.775, 0]);
  assert.deepEqual(where("three axles").rear_wheel, [-2.4, 0]);
  assert.deepEqual(where("train").bogie_rear, [-9.5, 0]);
  assert.deepEqual(of("train").scene.tyres.map(({ x }) => Math.round(100 * x) / 100), [10.78, 8.22, -8.22, -10.78]);
  const [ahead, left] = where("full car").unsprung_front_left;
  near(ahead, 1.2, FEW, "ahead");
  near(left, 0.76, FEW, "to the left");
  assert.deepEqual(where("seat in a full car").occupant, [0.2, 0.4]);
  near(where("rockers").front_wheel[0], 0.8, FEW, "under the push rod of the rocker");
  near(where("beam").first[0] - where("beam").second[0], 1.4, FEW, "both ends of a beam");
  assert.deepEqual(ALL.filter(({ scene: { oblique } }) => oblique).map(({ name }) => name).filter((name, i, all) =>
    all.indexOf(name) === i), ["full car", "full car on two tracks", "seat in a full car"]);
});

test("levels are what stands on what", () => {
  const levels = (name) => of(name).scene.bodies.toSorted((a, b) => a.level - b.level).map(({ name: body }) => body);
  assert.deepEqual(levels("building"), ["floor_1", "floor_2", "floor_3", "absorber"]);
  assert.deepEqual(levels("seat"), ["unsprung", "sprung", "occupant"]);
  for (const { name, made } of ALL) {
    for (const { top, bottom } of made.struts) assert.ok(top - bottom > 8, `${name}: a strut of ${top - bottom} px`);
  }
  const link = of("building").made.struts.find(({ strut }) => strut.name === "link");
  const [floor3] = [...of("building").made.bodies.values()].filter(({ body }) => body.name === "floor_3");
  assert.ok(link.shift - link.plan.left * link.wide > floor3.to, "the link passes the floor that it does not touch");
});

test("a rigid body stays straight, and each of its points is as high as heave, pitch and roll say", () => {
  always(({ name, made }, moment) => {
    for (const own of made.bodies.values()) {
      const { body, from, to, thick, z } = own;
      const corners = cornersOf(made, own, moment);
      const [x0] = made.project(body.x, body.y, 0);
      for (const [corner, up] of [[corners[0], -thick / 2], [corners[1], -thick / 2], [corners[2], thick / 2]]) {
        const ahead = (corner[0] - x0) / made.metre;
        const height = (moment.pose[body.heave] ?? 0) + ahead * (moment.pose[body.pitch] ?? 0);
        const rest = made.project(body.x, body.y, z + up)[1];
        if (!made.scene.oblique) near(corner[1], rest - made.lift * height, FEW, `${name} ${body.name}`);
      }
      if (to > from && !made.scene.oblique) {
        near(corners[0][0], x0 + from, FEW, `${name}: the rear end of ${body.name}`);
        const slope = (corners[1][1] - corners[0][1]) / (corners[1][0] - corners[0][0]);
        near(slope, (-made.lift / made.metre) * (moment.pose[body.pitch] ?? 0), FEW, `${name}: the slope`);
      }
    }
  });
});

test("a body pivots about its own middle, which only heaves", () => {
  for (const name of ["half car", "train", "three axles"]) {
    const { made, scene: { main } } = of(name);
    const own = made.bodies.get(main);
    const turned = { ...REST, pose: { [main.pitch]: 0.01 } };
    const [[x0, y0], [x1, y1]] = cornersOf(made, own, turned);
    const [x, y] = made.project(main.x, main.y, own.z - own.thick / 2);
    const onLine = y0 + ((x - x0) / (x1 - x0)) * (y1 - y0);
    if (x1 > x0) near(onLine, y, FEW, name);
    const [front, rear] = [made.struts.find(({ strut }) => strut.x > main.x), made.struts.find(({ strut }) =>
      strut.x < main.x)].map((one) => endsOf(made, one, turned.pose).top - endsOf(made, one, {}).top);
    assert.ok(front < 0 && rear > 0, `${name}: nose up`);
  }
});

test("wheels are under their mounts, and stand on their roads", () => {
  always(({ name, made, motion }, moment) => {
    for (const one of made.struts) {
      const { lower } = one.strut;
      if (lower.body?.kind !== "wheel" || one.lever) continue;
      near(made.project(lower.body.x, lower.body.y, 0)[0], endsOf(made, one, moment.pose).x, FEW, name);
    }
    if (!motion) return;
    const shapes = posed(made, moment);
    const roads = shapes.filter((shape) => shape.class === "road");
    for (const tyre of made.scene.tyres) {
      const [px, rest] = made.project(tyre.x, tyre.y, 0);
      const floor = rest - made.lift * moment.pose[tyre.road];
      const gap = Math.min(...roads.flatMap(({ points }) => points.filter(([x]) => Math.abs(x - px) <= 2.1)
        .map(([, y]) => Math.abs(y - floor))));
      assert.ok(gap < 7, `${name}: the road is ${gap} px from under ${tyre.name}`);
    }
  });
});

test("a strut is as long as both ends of it are apart in the simulation", () => {
  always(({ name, made }, moment) => {
    for (const one of made.struts) {
      const { upper, lower } = one.strut;
      const [rest, now] = [endsOf(made, one, {}), endsOf(made, one, moment.pose)];
      const travel = heightOf(upper.port, moment.pose) - heightOf(lower.port, moment.pose);
      near(now.bottom - now.top - (rest.bottom - rest.top), made.lift * travel, 1e-4, `${name} ${one.strut.name}`);
    }
  });
});

test("the travels inside a strut add up to its own", () => {
  always(({ name, made, motion }, moment) => {
    if (!motion) return;
    for (const { strut, plan } of made.struts) {
      const travel = heightOf(strut.upper.port, moment.pose) - heightOf(strut.lower.port, moment.pose);
      near(travelOf(plan, moment.travels[strut.name]), travel, 2e-6, `${name} ${strut.name}`);
    }
    for (const { tyre, plan } of made.primaries) {
      const travel = heightOf(tyre.port, moment.pose) - moment.pose[tyre.road];
      near(travelOf(plan, moment.travels[tyre.name]), travel, 2e-6, `${name} ${tyre.name}`);
    }
  });
});

/** @param {any[]} shapes */
const pointsOf = (shapes) => shapes.flatMap((shape) => (shape.kind === "circle" || shape.kind === "text"
  ? [[shape.x, shape.y]] : shape.points));

test("each element begins and ends where its neighbours do, so that the network closes", () => {
  always(({ name, made }, moment) => {
    for (const one of made.struts) {
      const travel = moment.travels[one.strut.name] ?? {};
      const into = [];
      const ends = endsOf(made, one, moment.pose);
      const long = ends.bottom - ends.top - made.lift * travelOf(one.plan, travel);
      draw(one.plan, ends.x, ends.top, long, { lift: made.lift, scale: one.scale, wide: one.wide, labels: false, travel,
        reach: made.range.reach[one.strut.name] ?? {}, states: {} }, into);
      const ys = pointsOf(into).map(([, y]) => y);
      const said = `${name} ${one.strut.name}`;
      near(Math.min(...ys), ends.top, 0.01, said);
      near(Math.max(...ys), ends.bottom, 0.01, said);
    }
  });
});

const plan = (element, value = 1) => planOf({ kind: "element", name: "e", key: element, value }, false);

/** Shapes of an element of 60 px that is so much longer. */
function at(element, travel, states = {}, value = 1) {
  const into = [];
  draw(plan(element, value), 0, 0, 60, { lift: 1000, scale: 1, wide: 1, labels: false, travel: { e: travel },
    reach: { e: 0.01 }, states }, into);
  return into;
}

test("an element at work: coils, piston, flywheel, block and pin are where its own travel puts them", () => {
  const coils = (travel) => at("spring", travel)[0].points;
  near(coils(0.01).at(-1)[1] - coils(0).at(-1)[1], 10, FEW, "the lower end of a spring");
  const cup = (travel) => at("damper", travel).find((shape) => shape.class === "oil").points[0][1];
  const piston = (travel) => at("damper", travel).find(({ points }) => points.length === 2 && points[0][1]
    === points[1][1]).points[0][1];
  near(piston(0.008) - cup(0.008) - (piston(0) - cup(0)), -8, FEW, "the piston in its cup");
  const hand = (travel) => {
    const [wheel] = at("inerter", travel).filter((shape) => shape.class === "flywheel");
    const [[, b], [c, d]] = at("inerter", travel).find(({ points }) => points?.[0][1] === wheel.y).points;
    return Math.atan2(c, b - d);
  };
  near(hand(0.002) - hand(0), 0.8, 1e-9, "a flywheel turns by its own travel");
  assert.ok(at("friction", 0, { e: "stick" }).some((shape) => shape.class === "block stick"));
  assert.ok(!at("friction", 0, { e: "slip up" }).some((shape) => shape.class === "block stick"));
  const wall = (travel) => at("friction", travel).find((shape) => shape.class === "hatch").points[0][1];
  near(wall(0.005) - wall(0), 5, FEW, "the wall moves with the lower end, the block does not");
  assert.ok(at("gap", 0, { e: "open" }, 0.002).some((shape) => shape.class === "wire open"));
  assert.ok(!at("gap", 0.002, { e: "upper contact" }, 0.002).some((shape) => shape.class === "wire open"));
  const pin = (travel) => at("gap", travel, {}, 0.002)[2].points[0][1] - at("gap", travel, {}, 0.002)[0].points[1][1];
  near(pin(0.002), 13, FEW, "in contact with the lower jaw");
  near(pin(-0.002), 1, FEW, "in contact with the upper jaw");
});

test("friction that sticks and open gaps are told by the simulation at that time", () => {
  const { made, motion, shaded, speed } = of("gap");
  const state = (element, at) => shaded.find((row) => row.element === element && row.intervals.some(([from, to]) =>
    from <= at && at < to)).state;
  for (const at of motion.time.slice(0, -1).map((time) => time + 0.003)) {
    const { states } = momentOf(made, motion, at, { speed, shaded });
    assert.deepEqual(states.strut, { g: state("g", at), f: state("f", at) });
  }
});

test("everything is in the picture, at all times", () => {
  always(({ name, size, made }, moment) => {
    for (const shape of posed(made, moment)) {
      for (const [x, y] of pointsOf([shape])) assert.ok(Number.isFinite(x) && Number.isFinite(y), `${name}`);
    }
    for (const { points } of posed(made, moment).filter((shape) => shape.class === "tyre")) {
      for (const [, y] of points) assert.ok(y < size.height, `${name}: a tyre at ${y} of ${size.height} px`);
    }
    for (const own of made.bodies.values()) {
      if (own.body.kind === "wheel") continue;
      for (const [x, y] of cornersOf(made, own, moment)) {
        assert.ok(x > -1 && x < size.width + 1, `${name}: ${own.body.name} at ${x} of ${size.width} px`);
        assert.ok(y > -4 && y < size.height, `${name}: ${own.body.name} at ${y} of ${size.height} px`);
      }
    }
  });
});

test("motions are drawn as large as fits, by a round number, and not by another one at each step of a slider", () => {
  for (const { name, scene: found, size, made, motion } of ALL) {
    if (!motion) continue;
    const range = rangeOf(found, [motion]);
    assert.ok(range.any * made.lift <= 0.151 * size.height || made.times === 1, name);
    assert.equal(layout(found, size, { ...range, any: 0.9 * range.any }, made.times).times, made.times, name);
  }
});

test("a road passes at the speed of the vehicle, to the scale along it; under one wheel as the caption says", () => {
  const { made, motion, speed } = of("half car");
  near(passing(made, 25), 25 * made.metre, FEW, "px a second");
  const axles = made.scene.wheelbase * made.metre;
  const time = Array.from({ length: 61 }, (_, i) => i / 60);
  const wave = (behind) => time.map((t) => 0.02 * Math.sin(9 * (t - behind / 25)));
  const roads = { road_front: wave(0), road_rear: wave(made.scene.wheelbase) };
  const moment = momentOf(made, { time, coordinates: {}, roads }, 0.5, { speed });
  near(moment.road("road_front", -axles), moment.pose.road_rear, 2e-5, "what the front wheel met, the rear one meets");
  const words = captions(of("quarter car").made, { moment, motion }, null).map(({ text }) => text);
  assert.ok(words.some((text) => text?.endsWith("road length not to scale")));
});

test("whose body is which stands above a strut, however wide that is", () => {
  let lines = 0;
  always(({ name, made, motion, scene: { column } }, moment) => {
    if (!column) return;
    const said = captions(made, { moment, motion }, { own: "S3", other: "S1" }).filter(({ text }) => /S[13]/.test(text));
    const top = Math.min(...made.struts.map((one) => endsOf(made, one, moment.pose).top));
    lines += said.length;
    for (const { y } of said) assert.ok(y < top, `${name}: ${y} is below ${top}`);
  });
  assert.ok(lines > 0);
});

test("roll that cannot be is said, and roll that is there is a number", () => {
  const words = (name) => {
    const { made, motion, moments } = of(name);
    return captions(made, { moment: moments[2], motion, passing: 1 }, null).map(({ text }) => text ?? "").join("; ");
  };
  assert.match(words("full car"), /roll 0: same road on both sides/);
  assert.match(words("full car on two tracks"), /roll −?\d\.\d\d°/);
});

test("an anti-roll bar joins the wheels of an axle, and the baseline is an outline of the body alone", () => {
  const { made, scene: found } = of("full car");
  assert.deepEqual(found.links.map(({ bodies }) => bodies.map(({ name }) => name)), [
    ["unsprung_front_left", "unsprung_front_right"], ["unsprung_rear_left", "unsprung_rear_right"],
  ]);
  assert.equal(posed(made, REST).filter((shape) => shape.class === "link").length, 2);
  for (const name of ["quarter car", "half car", "full car", "train"]) {
    const dashed = outlines(of(name).made, of(name).moments[1]);
    assert.ok(dashed.length > 0 && dashed.every((shape) => shape.class.startsWith("other")), name);
  }
});

test("names of elements are counted as the server counts them", () => {
  const leaf = (name) => ({ kind: "element", name, key: "spring", value: 1 });
  const keys = planOf({ kind: "parallel", parts: [leaf("k"), { kind: "series", parts: [leaf("c"), leaf("k")] }] }, false);
  assert.deepEqual([keys.parts[0].key, ...keys.parts[1].parts.map(({ key }) => key)], ["k", "c", "k 2"]);
});

test("a picture of sixty times a second takes a small part of a frame", () => {
  const { made, motion, shaded, speed } = of("full car");
  const began = process.cpuUsage();
  for (let i = 0; i < 100; i += 1) posed(made, momentOf(made, motion, i / 100, { speed, shaded }));
  const { user, system } = process.cpuUsage(began);
  assert.ok((user + system) / 1000 / 100 < 8, "[ms] of a processor, whatever else it does");
});

test("the road has no step at the beginning, when one wheel alone has seen what is between two", () => {
  for (const { name, made, moments } of ALL.filter(({ name }) => ["half car", "three axles"].includes(name))) {
    const steepest = (moment) => {
      const { points } = posed(made, moment).find((shape) => shape.class === "road");
      return Math.max(...points.slice(1).map(([, y], i) => Math.abs(y - points[i][1])));
    };
    const later = Math.max(...moments.slice(moments.length >> 1).map(steepest));
    assert.ok(steepest(moments[0]) <= 1.2 * later, `${name}: ${steepest(moments[0])} px, later at most ${later}`);
  }
});
