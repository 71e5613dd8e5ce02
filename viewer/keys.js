// The keys of a scene file whose values can be changed in the page.
'use strict';

// By table: its title in the scene file, and its keys, each with the object and the place there of its value, and its limits. Tables that occur
// several times in a file have titles in double brackets, and each its own id.
function keyTables(scene, look) {
  const { layers, keys = [] } = scene, tables = new Map(), inside = (root, path) => path.reduce((found, part) => found[part], root);
  const add = (title, id, key) => {
    if (!tables.has(id)) tables.set(id, { title, id, keys: [] });
    tables.get(id).keys.push({ title, id, ...key });
  };
  for (const { table, name, path, limits } of keys) add(table, table, { name, path, holder: inside({ scene, look }, path.slice(0, -1)), at: path.at(-1), limits });
  const all = kind => layers[kind].map((_, i) => [kind, i]), titles = { slabs: '[slab]', distance: '[marched]', density: '[marched]' };
  for (const [table, limits] of Object.entries(layers?.limits ?? {})) {
    const title = titles[table] ?? (table.startsWith('grade.') ? 'grade' : table);
    for (const path of titles[table] ? all(table) : table === 'sky' ? [['sky', 'smooth_disc']] : [table.split('.')])
      for (const [name, limit] of Object.entries(limits)) add(title, titles[table] ? path.join('.') : title, { name, path: [...path, name], holder: inside(layers, path), at: name, limits: limit });
  }
  return [...tables.values()];
}

// Gives a scene copies of the looks that it uses: keys are set for one scene, also where others have the same look.
function ownLooks({ looks }, from, to) {
  for (const [name, index] of Object.entries(looks)) looks[name] = to.push(structuredClone(from[index])) - 1;
}

// Keys that were set by hand in the scene before, stay so in one that its file has made anew, unless the file has another value for them now.
function keepKeys(before, scene, looks) {
  if (!before?.written || before.name !== scene.name) return;
  for (const { keys } of keyTables(scene, looks[scene.looks[scene.look]]))
    for (const { path, holder, at } of keys) {
      const key = path.join('.'), set = before.written.get(key);
      if (!set || JSON.stringify(holder[at]) !== set.was) continue;
      holder[at] = structuredClone(set.value);
      (scene.written ??= new Map()).set(key, set);
    }
}
