module bulk_elements
  !! The elements of the mesh as the driver keeps them: what each one precomputed (`table`), its history, and the one
  !! loop that calls them all. Memory is what the elements ask for, element by element.
  use kinds, only: wp, i8
  use status_codes, only: ok
  use model_data, only: model_type
  use equation_system, only: equation_system_type
  use user_element, only: element_geometry, element_state, element_energy, task_prepare, task_tangent
  implicit none (type, external)
  private
  public :: bulk_type, prepare_bulk, assemble_bulk, commit_bulk, roll_back_bulk, bind_geometry, add_moved_force

  type :: bulk_type
    integer(i8), allocatable :: table_ptr(:)        !! (ne+1) where an element's table begins
    integer(i8), allocatable :: hist_ptr(:)         !! (ne+1) where its history begins
    real(wp), allocatable :: table(:)
    real(wp), allocatable :: hist(:), hist_n(:)     !! of this step; committed
    integer :: nen_max = 0
  end type bulk_type

contains

  subroutine bind_geometry(model, e, geo, xe)
    !! Point geo at element e and gather its control points.
    type(model_type), intent(in), target :: model
    integer, intent(in) :: e
    type(element_geometry), intent(inout) :: geo
    real(wp), contiguous, target, intent(inout) :: xe(:, :)   !! work (ndm, at least nen)
    integer, pointer, contiguous :: nodes(:)

    nodes => model%mesh%connectivity(e)
    geo%ndm = model%ndm
    geo%dp = model%mesh%dp(e)
    geo%nen = size(nodes)
    geo%degree = model%mesh%degree(:, e)
    geo%ce => model%mesh%operator(e)
    call gather(nodes, model%x, xe)
    geo%xe => xe(:, 1:geo%nen)
  end subroutine bind_geometry

  pure subroutine gather(nodes, values, local)
    !! The values of an element's nodes.
    integer, intent(in) :: nodes(:)
    real(wp), contiguous, intent(in) :: values(:, :)      !! of all nodes (at least size(local,1),nn)
    real(wp), contiguous, intent(inout) :: local(:, :)    !! (:, at least size(nodes))

    ! a literal passed by value spares a call of memmove for each node
    select case (size(local, 1))
    case (2)
      call gather_components(2, size(values, 1), size(nodes), nodes, values, local)
    case (3)
      call gather_components(3, size(values, 1), size(nodes), nodes, values, local)
    case default
      call gather_components(size(local, 1), size(values, 1), size(nodes), nodes, values, local)
    end select
  end subroutine gather

  pure subroutine gather_components(m, rows, n, nodes, values, local)
    integer, value :: m, rows, n
    integer, intent(in) :: nodes(n)
    real(wp), intent(in) :: values(rows, *)
    real(wp), intent(inout) :: local(m, n)
    integer :: a, i

    do a = 1, n
      do i = 1, m
        local(i, a) = values(i, nodes(a))
      end do
    end do
  end subroutine gather_components

  subroutine prepare_bulk(model, bulk, status, element)
    !! Size the stores and let every element precompute what does not change.
    type(model_type), intent(inout), target :: model
    type(bulk_type), intent(inout), target :: bulk
    integer, intent(out) :: status     !! of the first element that failed
    integer, intent(out) :: element    !! that element
    real(wp), allocatable, target :: xe(:, :), we(:)
    real(wp) :: fe(0, 0), ke(0, 0, 0, 0)
    type(element_geometry) :: geo
    type(element_state) :: state
    type(element_energy) :: energy
    integer :: e, ne, ntable, nhist

    ne = model%mesh%ne
    status = ok
    element = 0
    bulk%nen_max = 0
    do e = 1, ne
      bulk%nen_max = max(bulk%nen_max, model%mesh%nen(e))
    end do
    allocate (xe(model%ndm, bulk%nen_max), we(bulk%nen_max))
    if (allocated(bulk%table_ptr)) deallocate (bulk%table_ptr, bulk%hist_ptr, bulk%table, bulk%hist, bulk%hist_n)
    allocate (bulk%table_ptr(ne + 1), bulk%hist_ptr(ne + 1))
    bulk%table_ptr(1) = 0
    bulk%hist_ptr(1) = 0
    do e = 1, ne
      call bind_geometry(model, e, geo, xe)
      call model%materials(model%material_of(e))%element%sizes(geo, ntable, nhist)
      bulk%table_ptr(e + 1) = bulk%table_ptr(e) + ntable
      bulk%hist_ptr(e + 1) = bulk%hist_ptr(e) + nhist
    end do
    allocate (bulk%table(bulk%table_ptr(ne + 1)))
    allocate (bulk%hist(bulk%hist_ptr(ne + 1)), source=0.0_wp)
    allocate (bulk%hist_n(bulk%hist_ptr(ne + 1)), source=0.0_wp)
    do e = 1, ne
      if (bulk%table_ptr(e + 1) == bulk%table_ptr(e)) cycle
      call bind_geometry(model, e, geo, xe)
      we(1:geo%nen) = model%w(model%mesh%connectivity(e))
      geo%we => we(1:geo%nen)
      geo%table => bulk%table(bulk%table_ptr(e) + 1:bulk%table_ptr(e + 1))
      state%hist => bulk%hist(bulk%hist_ptr(e) + 1:bulk%hist_ptr(e + 1))
      state%hist_n => bulk%hist_n(bulk%hist_ptr(e) + 1:bulk%hist_ptr(e + 1))
      call model%materials(model%material_of(e))%element%evaluate(task_prepare, geo, state, fe, ke, energy, status)
      if (status /= ok) then
        element = e
        return
      end if
    end do
  end subroutine prepare_bulk

  subroutine assemble_bulk(model, bulk, task, u, un, du, moves, time, dt, system, f, f_moved, stored, dissipated, &
                           status, element)
    !! Add every element's force to f and, in task_tangent, its tangent to the matrix. Elements of which a node `moves`
    !! with a prescribed increment or rate du add ke du to f_moved.
    type(model_type), intent(inout), target :: model
    type(bulk_type), intent(inout), target :: bulk
    integer, intent(in) :: task                     !! task_residual or task_tangent
    real(wp), contiguous, intent(in) :: u(:, :), un(:, :)  !! control values now and committed (ndf,nn)
    real(wp), intent(in) :: du(:, :)                !! prescribed increments not yet in u (ndf,nn)
    logical, intent(in) :: moves(:)                 !! (nn) du is not zero there; size 0: nowhere
    real(wp), intent(in) :: time, dt
    type(equation_system_type), intent(inout) :: system
    real(wp), intent(inout) :: f(:, :)              !! nodal forces (ndf,nn)
    real(wp), intent(inout) :: f_moved(:, :)        !! their first-order change by du (ndf,nn)
    real(wp), intent(inout) :: stored, dissipated   !! energies
    integer, intent(out) :: status, element         !! the first failure and its element
    real(wp), target :: xe(model%ndm, bulk%nen_max), ue(model%ndf*bulk%nen_max), une(model%ndf*bulk%nen_max)
    real(wp), target :: we(bulk%nen_max), fwork(model%ndf*bulk%nen_max)
    real(wp), allocatable, target :: kwork(:)
    real(wp), pointer, contiguous :: fe(:, :), ke(:, :, :, :)
    integer, pointer, contiguous :: nodes(:)
    type(element_geometry) :: geo
    type(element_state) :: state
    type(element_energy) :: energy
    integer :: e, a, ndf, n

    allocate (kwork(merge((model%ndf*bulk%nen_max)**2, 0, task == task_tangent)))
    status = ok
    element = 0
    state%time = time
    state%dt = dt
    do e = 1, model%mesh%ne
      associate (el => model%materials(model%material_of(e))%element)
        nodes => model%mesh%connectivity(e)
        n = size(nodes)
        ndf = el%ndf
        call bind_geometry(model, e, geo, xe)
        do a = 1, n
          we(a) = model%w(nodes(a))
        end do
        geo%we => we(1:n)
        geo%table => bulk%table(bulk%table_ptr(e) + 1:bulk%table_ptr(e + 1))
        state%hist => bulk%hist(bulk%hist_ptr(e) + 1:bulk%hist_ptr(e + 1))
        state%hist_n => bulk%hist_n(bulk%hist_ptr(e) + 1:bulk%hist_ptr(e + 1))
        state%ue(1:ndf, 1:n) => ue
        state%un(1:ndf, 1:n) => une
        call gather(nodes, u, state%ue)
        call gather(nodes, un, state%un)
        fe(1:ndf, 1:n) => fwork
        if (task == task_tangent) then
          ke(1:ndf, 1:n, 1:ndf, 1:n) => kwork
        else
          ke(1:0, 1:0, 1:0, 1:0) => kwork
        end if
        call el%evaluate(task, geo, state, fe, ke, energy, status)
        if (status /= ok) then
          element = e
          return
        end if
        stored = stored + energy%stored
        dissipated = dissipated + energy%dissipated
        if (task == task_tangent) then
          if (size(moves) > 0) then
            if (any(moves(nodes))) call add_moved_force(ke, du, nodes, el%symmetric, f_moved)
          end if
          call system%add_element(e, nodes, ke, el%symmetric)
        end if
        do a = 1, n
          f(1:ndf, nodes(a)) = f(1:ndf, nodes(a)) + fe(:, a)
        end do
      end associate
    end do
  end subroutine assemble_bulk

  pure subroutine add_moved_force(ke, du, nodes, symmetric, f_moved)
    !! Add ke du to nodal forces, with ke as its element fills it.
    real(wp), contiguous, intent(in) :: ke(:, :, :, :)  !! (ndf,nen,ndf,nen)
    real(wp), intent(in) :: du(:, :)                    !! (>=ndf,nn)
    integer, intent(in) :: nodes(:)                     !! of the element (nen)
    logical, intent(in) :: symmetric                    !! only blocks a >= b are filled
    real(wp), intent(inout) :: f_moved(:, :)            !! (>=ndf,nn)
    integer :: a, b, i, k

    do b = 1, size(nodes)
      do a = merge(b, 1, symmetric), size(nodes)
        do k = 1, size(ke, 3)
          do i = 1, size(ke, 1)
            f_moved(i, nodes(a)) = f_moved(i, nodes(a)) + ke(i, a, k, b)*du(k, nodes(b))
            if (symmetric .and. a > b) &
              f_moved(k, nodes(b)) = f_moved(k, nodes(b)) + ke(i, a, k, b)*du(i, nodes(a))
          end do
        end do
      end do
    end do
  end subroutine add_moved_force

  subroutine commit_bulk(bulk)
    !! The step converged: its history is the new committed one.
    type(bulk_type), intent(inout) :: bulk
    if (size(bulk%hist) > 0) bulk%hist_n = bulk%hist
  end subroutine commit_bulk

  subroutine roll_back_bulk(bulk)
    !! The step is rejected.
    type(bulk_type), intent(inout) :: bulk
    if (size(bulk%hist) > 0) bulk%hist = bulk%hist_n
  end subroutine roll_back_bulk
end module bulk_elements
