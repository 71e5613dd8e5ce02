/** The same field with cells that are so many times larger, for many shadows. @param {Caster} caster @returns {Caster} */
export function coarserCaster({ origin, cell_size, cells, fractions }: Caster, factor: any): Caster;
export class SweptShadow {
    constructor(caster: any, to_own: any, extinction: any, to_light: any, { strength, softness }: {
        strength: any;
        softness: any;
    });
    origin: any;
    cell_size: any;
    to_own: any;
    axis: number;
    across: number;
    aside: number;
    slopes: number[];
    left: number;
    bottom: number;
    width: number;
    height: number;
    sums: Float64Array<ArrayBuffer>;
    cells: any;
    towards: number;
    spread: number;
    is_above: boolean;
    low: number;
    high: number;
    sumsOf({ cell, first, last }: {
        cell: any;
        first: any;
        last: any;
    }, darkness: any): Float64Array<ArrayBuffer>;
    vectorToOwn(v: any): number[];
    integralTo(u: any, v: any): number;
    shareAt(point: any): number;
    wayThrough(point: any): {
        u: number;
        v: number;
        enters: number;
        leaves: number;
    };
    absorbedOver(zero: any, one: any, other: any, [columns, rows]: [any, any], take: any): void;
    corners(): number[][];
    known_corners: number[][];
    frame(): number[];
}
