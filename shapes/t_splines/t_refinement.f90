module t_refinement
  !! Refinement of T-meshes, and which cells to refine.
  !!
  !! `refine_cells` bisects marked cells as Morgenstern and Peterseim do: a cell of level k is
  !! halved in direction 1 + mod(k,2), and cells of lower level in the (p,q)-neighbourhood of a
  !! marked cell are marked too. The mesh stays analysis-suitable, and marking costs at most a
  !! constant number of cells for each marked one. The neighbourhood of a cell holds the cells whose
  !! centres lie within, counted in sizes of the cell in the index domain, floor(p/2) + 1/2 in the
  !! direction of its split and ceil(p/2) + 1/2 across it (p the degree of the respective
  !! direction). The proof asks for degrees above 1 and there are counterexamples with 1, so degree
  !! 1 takes the neighbourhood of degree 3: extensions grow with the degree.
  !! (P. Morgenstern, D. Peterseim, Analysis-suitable adaptive T-mesh refinement with linear
  !! complexity, CAGD 34, 2015.)
  !!
  !! `split_cells` halves cells in one direction as asked and nothing else, for example rows of
  !! T-junctions towards an edge; whether the result is suitable is `t_suitability`'s to say.
  use kinds, only: wp, i8
  use status_codes, only: ok, bad_t_mesh
  use nurbs_patch, only: nurbs_patch_type, evaluate_grid
  use t_mesh, only: t_mesh_type, cell_list, bay, append
  implicit none (type, external)
  private
  public :: refine_cells, refine_box, split_cells, split_box
  public :: cells_in_box, cells_in_place, cells_near_side, cells_below_level, rows_at_side

  !> samples of a cell in each direction that stand for its place in space
  integer, parameter :: samples = 5
  !> relative; whether a cell lies on a bound must not hang on the rounding of its corners
  real(wp), parameter :: touching = 1.0e-9_wp

contains

  pure subroutine refine_cells(mesh, marked, status)
    type(t_mesh_type), intent(inout) :: mesh   !! regular (no free splits, knots not repeated)
    integer, intent(in) :: marked(:)           !! leaves; other cells are ignored
    integer, intent(out) :: status             !! ok, bad_t_mesh (not regular, or lines too close)

    type(cell_list) :: queue, near
    logical, allocatable :: in_queue(:)
    logical :: done
    integer :: cell, i, j, k

    status = bad_t_mesh
    if (.not. mesh%regular) return
    allocate (in_queue(mesh%n), source=.false.)
    do i = 1, size(marked)
      if (marked(i) < 1 .or. marked(i) > mesh%n) cycle
      if (mesh%split(marked(i)) == 0) call mark(marked(i), in_queue, queue)
    end do

    i = 0
    do while (i < queue%n)
      i = i + 1
      cell = queue%id(i)
      call neighbourhood(mesh, cell, near)
      do j = 1, near%n
        k = near%id(j)
        if (mesh%level(k) < mesh%level(cell)) call mark(k, in_queue, queue)
      end do
    end do

    do i = 1, queue%n
      cell = queue%id(i)
      k = direction_of(mesh, cell)
      call mesh%split_cell(cell, k, mesh%middle(cell, k), done)
      if (.not. done) then
        mesh%regular = .false.
        return
      end if
    end do
    status = ok
  end subroutine refine_cells

  pure subroutine mark(cell, in_queue, queue)
    integer, intent(in) :: cell                  !! a leaf
    logical, intent(inout) :: in_queue(:)        !! of each cell
    type(cell_list), intent(inout) :: queue

    if (in_queue(cell)) return
    in_queue(cell) = .true.
    call append(queue, cell)
  end subroutine mark

  pure integer function direction_of(mesh, cell)
    !! Direction in which regular refinement halves a cell.
    type(t_mesh_type), intent(in) :: mesh
    integer, intent(in) :: cell      !! a leaf

    direction_of = 1 + mod(mesh%level(cell), 2)
  end function direction_of

  pure subroutine neighbourhood(mesh, cell, near)
    !! Leaves whose centres lie in the (p,q)-neighbourhood; twofold indices keep it exact.
    type(t_mesh_type), intent(in) :: mesh
    integer, intent(in) :: cell                  !! a leaf
    type(cell_list), intent(inout) :: near

    integer(i8) :: centre(2), reach(2)
    integer :: d, i, k, n

    d = direction_of(mesh, cell)
    reach = max(mesh%degree, 3) + 2                ! twice ceil(p/2) + 1/2, p odd
    reach(d) = reach(d) - 2                        ! twice floor(p/2) + 1/2
    reach = reach * (mesh%hi(:,cell) - mesh%lo(:,cell))
    centre = mesh%lo(:,cell) + mesh%hi(:,cell)
    call mesh%cells_over((centre - reach) / 2 - 1, (centre + reach) / 2 + 1, near)
    n = 0
    do i = 1, near%n
      k = near%id(i)
      if (any(abs(mesh%lo(:,k) + mesh%hi(:,k) - centre) > reach)) cycle
      n = n + 1
      near%id(n) = k
    end do
    near%n = n
  end subroutine neighbourhood

  pure subroutine refine_box(mesh, lo, hi, levels, status)
    !! Regular refinement until all cells over a box are halved `levels` times in each direction.
    type(t_mesh_type), intent(inout) :: mesh     !! regular
    real(wp), intent(in) :: lo(2), hi(2)         !! corners of the box, parameters
    integer, intent(in) :: levels                !! how often, >= 0
    integer, intent(out) :: status               !! ok or bad_t_mesh

    integer, allocatable :: marked(:)

    status = bad_t_mesh
    if (.not. mesh%regular) return
    do
      marked = cells_below_level(mesh, cells_in_box(mesh, lo, hi), 2 * levels)
      if (size(marked) == 0) exit
      call refine_cells(mesh, marked, status)
      if (status /= ok) return
    end do
    status = ok
  end subroutine refine_box

  pure subroutine split_cells(mesh, marked, d, halved)
    !! Halves cells in one direction, without closure.
    type(t_mesh_type), intent(inout) :: mesh     !! no longer regular
    integer, intent(in) :: marked(:)             !! leaves; other cells are ignored
    integer, intent(in) :: d                     !! direction across the new lines
    integer, intent(out) :: halved               !! number of cells that were split; empty ones and
                                                 !! those without room are not

    integer :: i, k
    logical :: done

    halved = 0
    do i = 1, size(marked)
      k = marked(i)
      if (k < 1 .or. k > mesh%n) cycle
      if (mesh%split(k) /= 0) cycle
      call mesh%split_cell(k, d, mesh%middle(k, d), done)
      if (done) halved = halved + 1
    end do
    if (halved > 0) mesh%regular = .false.
  end subroutine split_cells

  pure subroutine split_box(mesh, lo, hi, d, times, halved)
    !! Halves all cells over a box in one direction, several times. Rows along the bottom edge get
    !! more lines across it by `split_box(mesh, [s0, t0], [s1, t0 + depth], 1, 1, halved)`: the
    !! T-junctions lie on the first line at or above the box.
    type(t_mesh_type), intent(inout) :: mesh     !! no longer regular
    real(wp), intent(in) :: lo(2), hi(2)         !! corners of the box, parameters
    integer, intent(in) :: d                     !! direction across the new lines
    integer, intent(in) :: times                 !! how often
    integer, intent(out) :: halved               !! number of cells that were split

    integer :: k, n

    halved = 0
    do k = 1, times
      call split_cells(mesh, cells_in_box(mesh, lo, hi), d, n)
      halved = halved + n
    end do
  end subroutine split_box

  pure function cells_in_box(mesh, lo, hi) result(cells)
    !! Leaves that overlap a box of parameters by more than an edge.
    type(t_mesh_type), intent(in) :: mesh
    real(wp), intent(in) :: lo(2), hi(2)      !! corners of the box
    integer, allocatable :: cells(:)

    type(cell_list) :: found
    real(wp) :: from(2), to(2)
    integer(i8) :: first(2), last(2)
    integer :: d, i, n

    do d = 1, 2
      associate (x => mesh%lines(d)%x)
        first(d) = bay * max(0, count(x < lo(d)) - 1)
        last(d) = bay * min(ubound(x, 1), count(x <= hi(d)))
      end associate
    end do
    call mesh%cells_over(first, last, found)
    n = 0
    do i = 1, found%n
      call mesh%cell_box(found%id(i), from, to)
      if (any(from >= hi .or. to <= lo)) cycle
      n = n + 1
      found%id(n) = found%id(i)
    end do
    allocate (cells(n))
    cells(:) = found%id(1:n)
  end function cells_in_box

  pure function cells_below_level(mesh, cells, level) result(few)
    !! Those of some cells that were halved less often than asked.
    type(t_mesh_type), intent(in) :: mesh
    integer, intent(in) :: cells(:)     !! cells
    integer, intent(in) :: level        !! number of splits, both directions together
    integer, allocatable :: few(:)

    integer :: i, n

    allocate (few(size(cells)))
    n = 0
    do i = 1, size(cells)
      if (mesh%level(cells(i)) >= level) cycle
      n = n + 1
      few(n) = cells(i)
    end do
    call shorten(few, n)
  end function cells_below_level

  pure function cells_in_place(mesh, patch, lo, hi) result(cells)
    !! Leaves that reach into a box in space or touch it: the bounds of 5 x 5 points of the cell
    !! meet it.
    type(t_mesh_type), intent(in) :: mesh
    type(nurbs_patch_type), intent(in) :: patch     !! the surface that the mesh belongs to
    real(wp), intent(in) :: lo(3), hi(3)            !! corners of the box [length]
    integer, allocatable :: cells(:)

    real(wp) :: x(3,samples**2), slack
    integer, allocatable :: all_cells(:)
    integer :: i, n

    all_cells = mesh%leaves()
    n = 0
    do i = 1, size(all_cells)
      if (mesh%is_empty(all_cells(i))) cycle
      call cell_samples(mesh, patch, all_cells(i), x)
      slack = touching * maxval(maxval(x, 2) - minval(x, 2))
      if (any(minval(x, 2) - slack > hi .or. maxval(x, 2) + slack < lo)) cycle
      n = n + 1
      all_cells(n) = all_cells(i)
    end do
    call move_alloc(all_cells, cells)
    call shorten(cells, n)
  end function cells_in_place

  pure function cells_near_side(mesh, patch, side, distance) result(cells)
    !! Leaves with a point nearer to a side than some distance: of 5 x 5 points of the cell that are
    !! dropped on the side along the lines of parameters, one is less far away.
    type(t_mesh_type), intent(in) :: mesh
    type(nurbs_patch_type), intent(in) :: patch     !! the surface that the mesh belongs to
    integer, intent(in) :: side                     !! 1: s=0, 2: s=1, 3: t=0, 4: t=1
    real(wp), intent(in) :: distance                !! [length]
    integer, allocatable :: cells(:)

    real(wp) :: end_of_domain, from(2), to(2), x(3,samples**2), foot(3,samples)
    integer, allocatable :: all_cells(:)
    integer :: across, i, j, k, n

    across = (side + 1) / 2
    end_of_domain = mesh%parameter_of(across, merge(0_i8, mesh%last(across), mod(side, 2) == 1))
    all_cells = mesh%leaves()
    n = 0
    do i = 1, size(all_cells)
      if (mesh%is_empty(all_cells(i))) cycle
      call cell_samples(mesh, patch, all_cells(i), x)
      call mesh%cell_box(all_cells(i), from, to)
      if (across == 1) then
        call evaluate_grid(patch, [end_of_domain], stations(from(2), to(2)), [0.5_wp], foot)
      else
        call evaluate_grid(patch, stations(from(1), to(1)), [end_of_domain], [0.5_wp], foot)
      end if
      do k = 1, samples**2
        j = 1 + mod(k - 1, samples)
        if (across == 1) j = 1 + (k - 1) / samples
        if (norm2(x(:,k) - foot(:,j)) >= (1 - touching) * distance) cycle
        n = n + 1
        all_cells(n) = all_cells(i)
        exit
      end do
    end do
    call move_alloc(all_cells, cells)
    call shorten(cells, n)
  end function cells_near_side

  pure subroutine shorten(list, n)
    integer, allocatable, intent(inout) :: list(:)    !! keeps its first n items
    integer, intent(in) :: n

    integer, allocatable :: whole(:)

    call move_alloc(list, whole)
    allocate (list(n))
    list(:) = whole(1:n)
  end subroutine shorten

  pure subroutine rows_at_side(mesh, side, rows, lo, hi)
    !! Box of the first rows of roots along a side, for `refine_box` and `split_box`.
    type(t_mesh_type), intent(in) :: mesh
    integer, intent(in) :: side               !! 1: s=0, 2: s=1, 3: t=0, 4: t=1
    integer, intent(in) :: rows               !! how many, from the side inward
    real(wp), intent(out) :: lo(2), hi(2)     !! corners of the box, parameters

    integer :: across, d, n

    do d = 1, 2
      lo(d) = mesh%lines(d)%x(0)
      hi(d) = mesh%lines(d)%x(ubound(mesh%lines(d)%x, 1))
    end do
    across = (side + 1) / 2
    associate (line => mesh%lines(across))
      n = ubound(line%root, 1)
      if (mod(side, 2) == 1) then
        hi(across) = line%x(line%root(max(0, min(n, rows))))
      else
        lo(across) = line%x(line%root(max(0, min(n, n - rows))))
      end if
    end associate
  end subroutine rows_at_side

  pure subroutine cell_samples(mesh, patch, cell, x)
    type(t_mesh_type), intent(in) :: mesh
    type(nurbs_patch_type), intent(in) :: patch
    integer, intent(in) :: cell              !! a cell
    real(wp), intent(out) :: x(:,:)          !! places of its samples (3,samples^2)

    real(wp) :: lo(2), hi(2)

    call mesh%cell_box(cell, lo, hi)
    call evaluate_grid(patch, stations(lo(1), hi(1)), stations(lo(2), hi(2)), [0.5_wp], x)
  end subroutine cell_samples

  pure function stations(from, to) result(x)
    real(wp), intent(in) :: from, to      !! interval
    real(wp) :: x(samples)

    integer :: i

    x = [(from + (to - from) * i / (samples - 1), i = 0, samples - 1)]
  end function stations
end module t_refinement
